"""`voltcam record`: a running camera into a file on this machine."""

import argparse
import signal
from pathlib import Path

from voltcam_client import camera
from voltcam_client.cli_arguments import URL_HELP, seconds
from voltcam_client.formats import SUFFIXES, check_writable, left_out
from voltcam_client.meter import short
from voltcam_client.record import Progress, record, size_bytes
from voltcam_client.terminal import live_line, until_signal


def configure(parser: argparse.ArgumentParser) -> None:
    formats = "\n".join(f"  {suffix:<10} {description}" for suffix, description in SUFFIXES.items())
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
    with until_signal(signal.SIGINT, signal.SIGTERM) as stopped, live_line() as show:
        progress = record(
            url,
            path,
            seconds=args.seconds,
            frames=not args.no_frames,
            overwrite=args.overwrite,
            stop=stopped.is_set,
            show=lambda progress: show(lambda: _in_words(progress, path)),
        )
    print("; ".join(filter(None, [_in_words(progress, path), left_out(path, frames=not args.no_frames)])))
    return 0


def _in_words(progress: Progress, path: Path) -> str:
    rate = progress.events / progress.seconds if progress.seconds else 0
    return (
        f"{path}: {progress.events} events, {progress.frames} frames, {short(size_bytes(path))}B "
        f"in {progress.seconds:.1f} s, {short(rate)} events/s, {progress.lost_packets} packets lost"
    )
