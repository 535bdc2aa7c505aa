"""`voltcam diagnose`: find what a camera file lacks to explain a recording, name it, add it, show it."""

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]
from tqdm import tqdm

from voltcam_simulator import Camera, camera_names

from ..health import inspect
from ..pages.page import write
from ..recordings import load
from .catalogue.entries import ENTRIES
from .catalogue.entry import Entry
from .outcome.accepted import accepted, camera_of, fitted
from .outcome.conclude import result_of
from .outcome.generic import terms_left
from .outcome.report import page_of
from .rig.workers import cores
from .search.excess import without_excess
from .search.hypothesis import start_of
from .search.identify import identify, short
from .search.loop import diagnose
from .search.settings import DEFAULTS, SearchSettings
from .search.state import Say, search_of
from .session import DiagnosisError, Session, session_of

RUNS_FOLDER = ".voltcam-runs"  # in --out, until all is done
LINE_PERIOD_S = 10.0
SIMULATIONS_BAR = "{desc:<34} {percentage:3.0f}% |{bar:24}| {n_fmt} of {total_fmt} simulations {elapsed}"


def configure(parser: argparse.ArgumentParser) -> None:
    """The command line of `voltcam diagnose`."""
    parser.description = (
        "Find where a camera file and a recording with frames and events disagree, name the physical effect\n"
        "that is missing, add it, and show on held-out data that the gap shrinks; or say that nothing is\n"
        "missing, or that it is nothing known."
    )
    parser.epilog = """\
examples:
  voltcam diagnose walk.aedat4 --camera mine.yaml --out walk/
  voltcam serve --camera walk/camera.yaml --source 0      the daemon, with what was missing

DIR/report.html is for people, DIR/result.json for machines, DIR/camera.yaml is the extended camera file.
After Ctrl-C the same command goes on from where it was."""
    parser.add_argument(
        "recording", metavar="RECORDING", type=Path, help="a recording with frames and events"
    )
    parser.add_argument(
        "--camera",
        metavar="FILE",
        required=True,
        help=f"a camera file, or one of {', '.join(camera_names())}",
    )
    parser.add_argument("--out", metavar="DIR", type=Path, required=True, help="folder for the results")
    parser.add_argument("--seed", metavar="N", type=_seed, default=0, help="of what is drawn (default: 0)")
    parser.add_argument(
        "--seconds", metavar="S", type=_duration, default=DEFAULTS.recording.seconds,
        help=f"of the recording to look at, from its beginning (default: {DEFAULTS.recording.seconds:g})",
    )  # fmt: skip
    parser.set_defaults(run=run)


# The order of sums, and so what is found, would depend on the number of threads.
@threadpool_limits.wrap(limits=1)  # type: ignore[untyped-decorator]
def run(
    arguments: argparse.Namespace, settings: SearchSettings = DEFAULTS, entries: Sequence[Entry] = ENTRIES
) -> int:
    """Diagnose, with a bar on standard error; what is found goes to standard output as it is found."""
    camera = Camera.load(arguments.camera)
    if arguments.out.exists() and not arguments.out.is_dir():
        raise DiagnosisError(f"{arguments.out} is a file: give a folder as --out")
    runs = arguments.out / RUNS_FOLDER
    try:
        with tqdm(total=0, disable=None, leave=False, bar_format=SIMULATIONS_BAR) as bar:
            say = partial(_say, bar=bar)
            session = _ready(arguments, camera, runs, say, bar, settings, entries)
            bar.set_description_str("What this recording can tell")
            _diagnose(session, arguments.out, say, settings)
    except KeyboardInterrupt:
        sys.stderr.write(
            f"voltcam: stopped; what was done is kept in {runs}: the same command goes on from there\n"
        )
        return 130
    session.rig.forget()
    return 0


def _ready(
    arguments: argparse.Namespace,
    camera: Camera,
    runs: Path,
    say: Say,
    bar: "tqdm[Any]",
    settings: SearchSettings,
    entries: Sequence[Entry],
) -> Session:
    """The recording and the camera file, less what of it the recording does not show."""
    inspection = inspect(load(arguments.recording))
    looked_at = replace(settings.recording, seconds=arguments.seconds)

    def ready(camera: Camera) -> Session:
        session = session_of(
            inspection, camera, runs, name=arguments.recording.absolute().name, seed=arguments.seed,
            processes=cores(), entries=entries, settings=looked_at, rig_settings=settings.rig,
        )  # fmt: skip
        say(f"Looking at {session.looked_at()}.")
        _follow(session, bar)
        return session

    session = ready(camera)
    bare = without_excess(session, search_of(session, settings, say))
    if bare is None:
        return session
    session.rig.end()
    return replace(ready(bare), given=session.given)


def _say(text: str, bar: "tqdm[Any]") -> None:
    tqdm.write(text, sys.stdout)
    sys.stdout.flush()
    bar.set_description_str(text.strip().partition("\n")[0].partition(".")[0][:34])


def _diagnose(session: Session, out: Path, say: Say, settings: SearchSettings) -> None:
    search, start = search_of(session, settings, say), start_of(session.parameters, settings)
    identifiability = identify(session.rig, start, session.candidates, settings)
    say(identifiability.text() + "\n")
    diagnosis = diagnose(search, start)
    generic = terms_left(session.sensor, diagnosis, say)
    named = diagnosis.verdict == "effects"
    given = session.on_clock(session.given.parameters)
    choice = accepted(session.sensor, given, fitted(diagnosis, generic), named, say)
    result = result_of(session, search, identifiability, diagnosis, generic, choice)
    say("\n" + result.sentence)
    for effect in result.effects:
        for parameter, size in effect.parameters.items():
            say(f"  {effect.name}.{parameter} = {short(size.value)}, {short(size.low)} to {short(size.high)}")
        if effect.next_recording:
            say(f"  to tell it from {' and '.join(effect.rivals)}, record: {effect.next_recording}")
    say("")
    texts: dict[str, Callable[[], str]] = {
        "result.json": lambda: result.model_dump_json(indent=2) + "\n",
        "camera.yaml": lambda: camera_of(session, choice.parameters).to_yaml(),
        "report.html": lambda: page_of(session, search, identifiability, diagnosis, result),
    }
    for file, text in texts.items():
        write(out / file, text())
        say(f"{out / file} written")


def _follow(session: Session, bar: "tqdm[Any]") -> None:
    """Let the bar show how many of the simulations that were asked for are done, from when none was."""

    counts = _Counts()

    def begin(runs: int) -> None:
        if bar.n >= bar.total:
            bar.n = bar.total = 0
        bar.total += runs
        bar.refresh()

    def end(runs: int) -> None:
        bar.update(runs)

    lines = (counts.begin, counts.end)
    session.rig.batch, session.rig.done = lines if bar.disable else (begin, end)


class _Counts:
    """What the bar shows, as a line now and then where there is no terminal for a bar."""

    def __init__(self) -> None:
        self._asked = self._done = 0
        self._told_s = time.monotonic()

    def begin(self, runs: int) -> None:
        self._asked += runs

    def end(self, runs: int) -> None:
        self._done += runs
        if time.monotonic() - self._told_s > LINE_PERIOD_S:
            self._told_s = time.monotonic()
            sys.stderr.write(f"voltcam: {self._done} of {self._asked} simulations asked for so far\n")
            sys.stderr.flush()


def _seed(text: str) -> int:
    """An argument's type; argparse shows its name to the user."""
    number = int(text)
    if not 0 <= number < 1 << 32:
        raise ValueError
    return number


def _duration(text: str) -> float:
    """A length of time in seconds, for argparse."""
    number = float(text)
    if not 0 < number < 1e6:
        raise ValueError
    return number
