"""`voltcam evaluate`: models against recordings, and the paper's figures; writes evaluation.md."""

import argparse
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from tqdm import tqdm

from voltcam_simulator.effect import Events

from ..distances import Region
from ..health import Inspection, inspect
from ..models.model import simulate
from ..recordings import load
from ..steps import told_steps
from .contenders import contenders
from .evaluate import Evaluation, judged, yardstick_of
from .folds import folds, pooled, pooled_region
from .later import later_part
from .page import write_evaluation

PAGES = Path("docs/how-it-works")


def configure(parser: argparse.ArgumentParser) -> None:
    """The command line of `voltcam evaluate`."""
    parser.description = (
        "Fit all models to a part of each recording, hold them against the rest, and write the table and\n"
        "the paper's figures to DIR/evaluation.md and DIR/evaluation/. Without a recording:\n"
        "the figures that need none."
    )
    parser.epilog = """\
examples:
  voltcam evaluate slider_depth/ street.aedat4     regenerates docs/how-it-works/evaluation.md
  voltcam evaluate run.npz --out /tmp/mine"""
    parser.add_argument(
        "recordings", metavar="RECORDING", nargs="*", type=Path, help="a recording with frames and events"
    )
    parser.add_argument("--out", metavar="DIR", type=Path, default=PAGES, help=f"default: {PAGES}")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Evaluate, with each step on standard error; verdicts go to standard output. What cannot be evaluated is
    a note on the page, and a line on standard error."""
    evaluations, notes = [], []
    with told_steps("{desc} [{elapsed}]") as step:
        step("reading")
        inspections = {path: inspect(load(path)) for path in arguments.recordings}
        # Whether all of them can be judged is known before the long work on the first.
        wholes = {path: yardstick_of(each, str(path)).region for path, each in inspections.items()}
        for path, inspection in inspections.items():
            name = path.absolute().stem

            def progress(text: str, name: str = name) -> None:
                step(f"{name}: {text}")

            try:
                done, told = _evaluated(inspection, wholes[path], name, progress)
            except ValueError as error:
                told = [" ".join(str(error).split())]
                tqdm.write(f"{name}: {told[0]}", file=sys.stderr)
            else:
                evaluations.append(done)
                verdict = [f"  {line.replace('**', '')}" for line in done.verdict()]
                tqdm.write("\n".join([f"{name}:", *verdict]))
            notes += [f"{name}: {each}" for each in told]
        page = write_evaluation(evaluations, arguments.out, notes, step)
    sys.stdout.write(f"{page} written\n")
    return 0


def _evaluated(
    inspection: Inspection, whole: Region, name: str, progress: Callable[[str], None]
) -> tuple[Evaluation, list[str]]:
    """The evaluation, and notes on how it came about."""
    ways = folds(whole, inspection.footage.events)
    parts: list[dict[str, Events]] = []
    notes: list[str] = []
    for number, (fitting, _) in enumerate(ways, 1):
        way = f" ({number} of {len(ways)})" if len(ways) > 1 else ""

        def step(text: str, way: str = way) -> None:
            progress(text + way)

        scene, makers, told = contenders(inspection, fitting, step)
        notes += [each + way for each in told]
        part = {}
        for model, make in makers.items():
            step(model)
            part[model] = simulate(make(), scene)
        parts.append(part)
    models = [model for model in parts[0] if all(model in part for part in parts)]
    simulated = {model: pooled([part[model] for part in parts], ways) for model in models}
    found = judged(inspection, simulated, pooled_region(whole, ways), name, progress)
    try:
        protocols = later_part(inspection, name, progress)
    except ValueError as error:
        protocols, notes = {}, [*notes, f"the later part was not judged: {' '.join(str(error).split())}"]
    return replace(found, protocols=protocols), notes
