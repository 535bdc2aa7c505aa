"""The `voltcam` command: `listen`, `record` and `status`, which need the bare install only, and the
commands that other packages add as entry points of the group `voltcam.commands`.

A command is a function `configure(parser)` that adds its arguments and sets the default `run`, a function
from the parsed arguments to the exit status. An entry point is imported when its command is the one to run,
and not for `voltcam --help`: its line there is in SUMMARIES.
"""

import argparse
import json
import math
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from importlib import metadata
from pathlib import Path
from typing import Any

from voltcam_client import camera, control, keys
from voltcam_client.formats import SUFFIXES, check_writable
from voltcam_client.meter import measure, short
from voltcam_client.record import Progress, record, size_bytes

SUMMARIES = {
    "serve": "run the camera: live video in, events out",
    "replay": "play a recording as a live camera, or verify how it was made",
    "convert": "turn a video, images or a recording into an event file",
    "calibrate": "find a camera's parameters from a recording of it",
    "diagnose": "find, name and add what a camera file lacks to explain a recording",
    "evaluate": "hold models against recordings; the paper's figures and tables",
    "bench": "measure the speed on this machine, beside its own limits",
    "doctor": "say what works here: devices, codecs, ports, and for how many pixels the speed is enough",
    "config": "check a configuration file before it is used",
    "schema": "print the JSON schema of the configuration file, for editors",
}
SHOW_PERIOD_S = 0.25
URL_HELP = f"where the camera is (default: {camera.DEFAULT_URL})"


def main(argv: Sequence[str] | None = None) -> int:
    """Run `voltcam`. Returns 0, 1 after an error, 2 where a command is not installed, 130 after Ctrl-C."""
    try:
        try:
            return _run(sys.argv[1:] if argv is None else list(argv))
        finally:
            sys.stdout.flush()
    except KeyboardInterrupt:
        return 128 + signal.SIGINT
    except BrokenPipeError:
        # Whoever read our output has gone, as in `voltcam listen | head`: there is nobody to tell.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 128 + signal.SIGPIPE
    except (OSError, ValueError) as error:
        print("voltcam:", " ".join(str(error).split()), file=sys.stderr)
        return 1


def _run(argv: list[str]) -> int:
    parser = argparse.ArgumentParser(
        prog="voltcam",
        description="An event camera that is not there: live video in, the events a DAVIS would give out.",
        epilog="`voltcam COMMAND --help` says more, with examples.",
    )
    parser.add_argument("--version", action="version", version=f"voltcam {metadata.version('voltcam')}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for name, (summary, configure) in OWN_COMMANDS.items():
        configure(_add_command(commands, name, summary))
    wanted = next((word for word in argv if not word.startswith("-")), None)
    extra = ""
    try:
        for entry in sorted(metadata.entry_points(group="voltcam.commands")):
            summary = SUMMARIES.get(entry.name, f"from {entry.module}")
            command = _add_command(commands, entry.name, summary)
            if entry.name == wanted:
                extra = "".join(entry.extras)
                entry.load()(command)
        args = parser.parse_args(argv)
        return int(args.run(args))
    except ImportError as error:
        if not extra:
            raise
        remedy = f"needs the {extra} extra: pip install 'voltcam[{extra}]'"
        print(f"voltcam {wanted} {remedy} ({error})", file=sys.stderr)
        return 2


def _add_command(commands: Any, name: str, summary: str) -> argparse.ArgumentParser:
    parser: argparse.ArgumentParser = commands.add_parser(
        name, help=summary, description=summary, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    return parser


# --- listen ---


def _configure_listen(parser: argparse.ArgumentParser) -> None:
    parser.description = "Print what comes from a running camera, one line per second, until Ctrl-C."
    parser.epilog = """\
examples:
  voltcam listen                                   the camera on this machine
  voltcam listen tcp://robot.local:5560 --seconds 10
  voltcam listen --json | jq .events_per_s

The latency is this machine's clock less the camera's: synchronise the two before you trust it."""
    parser.add_argument("url", metavar="URL", nargs="?", default=camera.DEFAULT_URL, help=URL_HELP)
    parser.add_argument("--seconds", metavar="N", type=seconds, help="end after N seconds")
    parser.add_argument("--json", action="store_true", help="print a JSON object per line")
    parser.set_defaults(run=_listen)


def _listen(args: argparse.Namespace) -> int:
    end = time.monotonic() + (args.seconds or math.inf)
    heard = False
    # A flag, because the exception of Ctrl-C is lost if it meets a destructor.
    with camera.EventCamera(args.url) as source, _until_signal(signal.SIGINT) as stopped:
        while (left_s := end - time.monotonic()) > 0:
            rates = measure(source, min(1.0, left_s), stopped.is_set)
            if stopped.is_set():
                return 128 + signal.SIGINT
            heard = heard or rates.packets_per_s > 0
            print(json.dumps(asdict(rates)) if args.json else rates, flush=True)
    if not heard:
        raise TimeoutError(f"nothing came from {args.url}: is `voltcam serve` running there?")
    return 0


# --- record ---


def _configure_record(parser: argparse.ArgumentParser) -> None:
    formats = "\n".join(f"  {suffix:<6} {description}" for suffix, description in SUFFIXES.items())
    parser.description = "Record a running camera into a file on this machine, until Ctrl-C."
    parser.usage = "voltcam record [-h] [--seconds N] [--no-frames] [--overwrite] [URL] FILE"
    parser.epilog = f"""\
formats, by the suffix of FILE:
{formats}

examples:
  voltcam record run.npz                           the camera on this machine
  voltcam record tcp://robot.local:5560 run.raw --seconds 60

What is recorded is safe at every moment: it can be read after Ctrl-C, a kill or a full disk."""
    # Not two positionals: argparse loses an optional one in front when options precede it.
    parser.add_argument("target", metavar="[URL] FILE", nargs="+", help=f"{URL_HELP}, and the file to write")
    parser.add_argument("--seconds", metavar="N", type=seconds, help="end after N seconds of recording")
    parser.add_argument("--no-frames", action="store_true", help="leave the frames out")
    parser.add_argument("--overwrite", action="store_true", help="replace FILE if it exists")
    parser.set_defaults(run=_record)


def _record(args: argparse.Namespace) -> int:
    if len(args.target) > 2:
        raise ValueError(f"record takes [URL] FILE, not {' '.join(args.target)}: quote names with blanks")
    url, file = [camera.DEFAULT_URL, *args.target][-2:]
    path = Path(file)
    check_writable(path, overwrite=args.overwrite)  # now, not when the first packet has come
    with _until_signal(signal.SIGINT, signal.SIGTERM) as stopped, _live_line() as show:
        progress = record(
            url,
            path,
            seconds=args.seconds,
            frames=not args.no_frames,
            overwrite=args.overwrite,
            stop=stopped.is_set,
            show=lambda progress: show(lambda: _in_words(progress, path)),
        )
    print(_in_words(progress, path))
    return 0


def _in_words(progress: Progress, path: Path) -> str:
    rate = progress.events / progress.seconds if progress.seconds else 0
    return (
        f"{path}: {progress.events} events, {progress.frames} frames, {short(size_bytes(path))}B "
        f"in {progress.seconds:.1f} s, {short(rate)} events/s, {progress.lost_packets} packets lost"
    )


@contextmanager
def _until_signal(*signals: signal.Signals) -> Iterator[threading.Event]:
    """Set by these signals, which then do no more than that: a write is not cut in two."""
    stopped = threading.Event()
    before = [signal.signal(number, lambda *_: stopped.set()) for number in signals]
    try:
        yield stopped
    finally:
        for number, handler in zip(signals, before, strict=True):
            signal.signal(number, handler)


@contextmanager
def _live_line() -> Iterator[Callable[[Callable[[], str]], None]]:
    """A line on the terminal, rewritten a few times a second; nothing where there is no terminal."""
    shown_s = 0.0

    def show(text: Callable[[], str]) -> None:
        nonlocal shown_s
        if sys.stderr.isatty() and time.monotonic() - shown_s > SHOW_PERIOD_S:
            shown_s = time.monotonic()
            print(f"\r\033[K{text()}", end="", file=sys.stderr, flush=True)

    try:
        yield show
    finally:
        if shown_s:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


# --- status ---


def _configure_status(parser: argparse.ArgumentParser) -> None:
    parser.description = "Print what a running daemon says of itself: rates, drops, source, recording."
    parser.epilog = """\
examples:
  voltcam status                                   the daemon on this machine
  voltcam status http://robot.local:8560 --json | jq .source"""
    default = control.DEFAULT_URL
    parser.add_argument(
        "url", metavar="URL", nargs="?", default=default, help=f"where the daemon is (default: {default})"
    )
    parser.add_argument("--json", action="store_true", help="print the whole answer as JSON")
    parser.set_defaults(run=_status)


def _status(args: argparse.Namespace) -> int:
    status = control.Control(args.url).status()
    if args.json:
        print(json.dumps(status, indent=2))
    else:
        lines = dict(_flat(status))
        width = max(map(len, lines), default=0)
        for name, value in lines.items():
            print(f"{name:<{width}}  {'-' if value is None or value == '' else value}")
    return 0


# --- keys ---


def _configure_keys(parser: argparse.ArgumentParser) -> None:
    parser.description = "Make the keys with which a camera's ZeroMQ stream is encrypted, and open to few."
    parser.epilog = """\
examples:
  voltcam keys /etc/voltcam/keys robot laptop   keys of the camera, and of two who may listen
then, in the camera's config file, `access: {curve_keys: /etc/voltcam/keys}`, and on the robot, with the
folder for-robot moved there:  VOLTCAM_KEYS=for-robot voltcam listen tcp://camera.local:5560"""
    parser.add_argument(
        "folder", metavar="FOLDER", type=Path, help="where the camera's keys are, or are to be"
    )
    parser.add_argument("clients", metavar="NAME", nargs="*", help="who may listen")
    parser.set_defaults(run=_keys)


def _keys(args: argparse.Namespace) -> int:
    for made in keys.make_keys(args.folder, args.clients):
        print(f"{made}  (to be moved to that machine, and named there in VOLTCAM_KEYS)")
    print(f"{args.folder}  (access.curve_keys of the camera's config file)")
    return 0


def _flat(tree: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """{"a": {"b": 1}} to ("a.b", 1)."""
    for name, value in tree.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value


def seconds(text: str) -> float:
    """An argument's type; argparse shows its name to the user."""
    number = float(text)
    if not 0 < number < math.inf:
        raise ValueError
    return number


OWN_COMMANDS = {
    "listen": ("print the rates, losses and latency of a running camera", _configure_listen),
    "record": ("record a running camera into a file", _configure_record),
    "status": ("print what a running daemon says of itself", _configure_status),
    "keys": ("make keys that open a camera's stream to few", _configure_keys),
}
