"""`make hidden-effects`."""

import argparse
import sys
from fnmatch import fnmatchcase
from pathlib import Path

from tqdm import tqdm

from .cases import REPORTED_FROM, grid
from .page import page
from .run import read, run

ROOT = Path(__file__).parents[2]


def main() -> int:
    """Run what is not yet run of the grid, then write the page of all that is."""
    parser = argparse.ArgumentParser(prog="make hidden-effects", description=__doc__)
    parser.add_argument("--seed", type=int, default=REPORTED_FROM)
    parser.add_argument("--cases", default="*", help="a pattern of case names, such as 'singles/flicker/*'")
    parser.add_argument("--jobs", type=int, default=2, help="processes at a time")
    arguments = parser.parse_args()
    reported = arguments.seed >= REPORTED_FROM
    own = f"results/hidden-effects/{arguments.seed}.md"
    target = ROOT / ("docs/how-it-works/hidden-effects.md" if reported else own)
    file = target.with_suffix(".jsonl")
    cases = grid(arguments.seed)
    wanted = [case for case in cases if fnmatchcase(case.name, arguments.cases)]
    if not wanted:
        sys.exit(f"no case is called {arguments.cases!r}: they are like {cases[0].name!r}")
    names, status = {case.name for case in wanted}, 0
    done = sum(line.case in names for line in read(file))
    try:
        with tqdm(total=len(wanted), initial=done, unit="case", smoothing=0.05) as bar:
            for line in run(wanted, file, arguments.jobs):
                bar.set_postfix_str(f"{line.case}: {line.verdict.verdict if line.verdict else 'crashed'}")
                bar.update()
    except KeyboardInterrupt:
        status = 130
    target.write_text(page(cases, read(file), arguments.seed), encoding="utf-8")
    again = ", the same call goes on" if status else ""
    sys.stderr.write(f"verdicts: {file.relative_to(ROOT)}, page: {target.relative_to(ROOT)}{again}\n")
    return status


if __name__ == "__main__":
    sys.exit(main())
