"""`make pairs`."""

import argparse
import sys
from pathlib import Path

from tqdm import tqdm

from .page import page
from .pairs import REPORTED_FROM, pairs
from .run import read, run

ROOT = Path(__file__).parents[2]
ASKED = 20


def main() -> int:
    """Run the pairs that have not run yet, then write the page of all that have."""
    parser = argparse.ArgumentParser(prog="make pairs", description=__doc__)
    parser.add_argument("--seed", type=int, default=REPORTED_FROM)
    parser.add_argument("--count", type=int, default=ASKED)
    parser.add_argument("--jobs", type=int, default=2, help="processes at a time")
    arguments = parser.parse_args()
    reported = arguments.seed >= REPORTED_FROM
    own = f"results/pairs/{arguments.seed}.md"
    target = ROOT / ("docs/how-it-works/camera-pairs.md" if reported else own)
    file = target.with_suffix(".jsonl")
    wanted, status = pairs(arguments.count, arguments.seed), 0
    seeds = {pair.seed for pair in wanted}
    done = sum(outcome.seed in seeds for outcome in read(file))
    try:
        with tqdm(total=len(wanted), initial=done, unit="pair", smoothing=0.05) as bar:
            for outcome in run(wanted, file, arguments.jobs):
                bar.set_postfix_str(outcome.error or f"{outcome.seed}: W1 {outcome.ratio('W1'):.2f}")
                bar.update()
    except KeyboardInterrupt:
        status = 130
    target.write_text(page(wanted, read(file)), encoding="utf-8")
    again = ", the same call goes on" if status else ""
    sys.stderr.write(f"figures: {file.relative_to(ROOT)}, page: {target.relative_to(ROOT)}{again}\n")
    return status


if __name__ == "__main__":
    sys.exit(main())
