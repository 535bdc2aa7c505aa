"""`voltcam calibrate`: a recording of a camera in, a camera file that behaves like it out."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from voltcam_simulator import Camera

from ..health import inspect
from ..recordings import load
from ..steps import told_steps
from .calibrate import CalibrationError
from .camera_from import camera_from
from .estimates import Estimate
from .page import write_report


def configure(parser: argparse.ArgumentParser) -> None:
    """The command line of `voltcam calibrate`."""
    parser.description = (
        "Find the parameters of the camera that made a recording with frames and events: k1 to k6,\n"
        "thresholds, refractory period, latency, mismatch, hot and dead pixels, with 90 % intervals."
    )
    parser.epilog = """\
examples:
  voltcam calibrate walk.aedat4 --out mine.yaml --report mine/
  voltcam serve --camera mine.yaml --source 0      the daemon, as that camera

A minute is good: some of it held still, some slow, some fast, from dark to bright."""
    parser.add_argument(
        "recording", metavar="RECORDING", type=Path, help="a recording with frames and events"
    )
    parser.add_argument(
        "--out", metavar="FILE", type=_camera_file, required=True, help="camera file to write (.yaml)"
    )
    parser.add_argument("--report", metavar="DIR", type=Path, help="write DIR/report.html, with figures")
    parser.add_argument(
        "--method",
        choices=("exact", "paper"),
        default="exact",
        help="exact: by the law of first passage (default); paper: as DVS-Voltmeter has it, for comparison",
    )
    parser.add_argument(
        "--camera", metavar="NAME", help="a camera of the recording's size to take all other effects from"
    )
    parser.add_argument(
        "--temperature", metavar="C", type=float, help="of the die during the recording (default: 25)"
    )
    parser.add_argument(
        "--no-refine",
        dest="refining",
        action="store_false",
        help="keep the likeliest parameters, even if others make events that are more like the recorded",
    )
    parser.add_argument("--seed", metavar="N", type=int, default=0, help="of what is drawn (default: 0)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Calibrate, with each step on standard error; health and parameters go to standard output."""
    base = Camera.load(arguments.camera) if arguments.camera else None
    if not arguments.out.absolute().parent.is_dir():
        raise CalibrationError(
            f"{arguments.out.parent} is not a folder: make it first, or give another --out"
        )
    inspection = inspect(load(arguments.recording))
    sys.stdout.write(inspection.health.text() + "\n\n")
    steps = STEPS[arguments.method] + (REFINING if arguments.refining and arguments.method == "exact" else 0)
    with told_steps(BAR, steps) as progress:
        found = camera_from(
            inspection,
            name=arguments.out.stem[:100],
            method=arguments.method,
            base=base,
            temperature_c=arguments.temperature,
            seed=arguments.seed,
            refining=arguments.refining,
            report=progress,
        )
        source = arguments.recording.absolute().name
        arguments.out.write_text(found.to_yaml(source), encoding="utf-8")
        written = [arguments.out]
        if arguments.report:
            progress("report")
            written.append(write_report(found, source, arguments.report, arguments.seed))
    tables = [*_table(found.estimates), *_moved(found.moved)]
    lines = [*tables, *found.notes, "", *(f"{path} written" for path in written)]
    sys.stdout.write("\n".join(lines) + "\n")
    return 0


STEPS = {"exact": 23, "paper": 2}  # and some for each kick of the frames, where there is one
REFINING = 21
BAR = "{desc:<20} {percentage:3.0f}% |{bar}| {elapsed}"


def _table(estimates: Sequence[Estimate]) -> list[str]:
    if not estimates:
        return []
    lines = [f"{'parameter':<38}{'value':>10}   {'90 % interval':<24}rests on"]
    for one in estimates:
        interval = f"{one.low:.3g} .. {one.high:.3g}"
        lines.append(
            f"{one.effect + '.' + one.parameter:<38}{one.value:>10.3g}   {interval:<24}{one.rests_on}"
        )
    return [*lines, ""]


def _moved(moved: Sequence[tuple[str, float, float]]) -> list[str]:
    if not moved:
        return []
    lines = [f"{'moved to behave as the recording':<38}{'likeliest':>10}   in the camera file"]
    lines += [f"{name:<38}{former:>10.3g}   {value:.3g}" for name, former, value in moved]
    return [*lines, ""]


def _camera_file(text: str) -> Path:
    """An argument's type; argparse shows its name to the user."""
    path = Path(text)
    if path.suffix not in (".yaml", ".yml"):
        raise argparse.ArgumentTypeError(f"{text} is no camera file: give a name that ends in .yaml")
    return path
