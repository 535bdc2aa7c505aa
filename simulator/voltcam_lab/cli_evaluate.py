"""`voltcam evaluate`: models against recordings, and the paper's figures, into docs/evaluation.md."""

import argparse
import sys
from pathlib import Path

from tqdm import tqdm

from .contenders import contenders
from .distances import held_out
from .evaluate import evaluate, yardstick_of
from .evaluation_page import write_evaluation
from .recordings import load


def configure(parser: argparse.ArgumentParser) -> None:
    """The command line of `voltcam evaluate`."""
    parser.description = (
        "Fit all models to a part of each recording, hold them against the rest, and write the table and\n"
        "the paper's figures to DIR/evaluation.md and DIR/evaluation/. Without a recording:\n"
        "the figures that need none."
    )
    parser.epilog = """\
examples:
  voltcam evaluate slider_depth/ street.aedat4     regenerates docs/evaluation.md
  voltcam evaluate run.npz --out /tmp/mine"""
    parser.add_argument(
        "recordings", metavar="RECORDING", nargs="*", type=Path, help="a recording with frames and events"
    )
    parser.add_argument("--out", metavar="DIR", type=Path, default=Path("docs"), help="default: docs")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Evaluate, with a bar on standard error; the verdicts go to standard output."""
    evaluations, notes = [], []
    with tqdm(bar_format="{desc} [{elapsed}]", disable=None, leave=False) as bar:
        bar.set_description_str("reading")
        recordings = {path: load(path) for path in arguments.recordings}
        # Whether all of them can be judged is known before the long work on the first.
        parts = [
            held_out(yardstick_of(recording, str(path)).region) for path, recording in recordings.items()
        ]
        for (path, recording), (fitting, judging) in zip(recordings.items(), parts, strict=True):
            name = path.stem

            def progress(step: str, name: str = name) -> None:
                bar.set_description_str(f"{name}: {step}")

            scene, makers, missing = contenders(recording, fitting, progress)
            notes += [f"{name}: {reason}" for reason in missing]
            done = evaluate(recording, makers, name=name, region=judging, scene=scene, progress=progress)
            evaluations.append(done)
            tqdm.write("\n".join([f"{name}:", *(f"  {line.replace('**', '')}" for line in done.verdict())]))
        page = write_evaluation(evaluations, arguments.out, notes, bar.set_description_str)
    sys.stdout.write(f"{page} written\n")
    return 0
