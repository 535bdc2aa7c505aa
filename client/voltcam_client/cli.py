"""The `voltcam` command: `listen`, `record` and `status`, which need the bare install only, and the
commands that other packages add as entry points of the group `voltcam.commands`.

A command is a function `configure(parser)` that adds its arguments and sets the default `run`, a function
from the parsed arguments to the exit status. An entry point is imported when its command is the one to run,
and not for `voltcam --help`: its line there is in SUMMARIES.
"""

import argparse
import os
import signal
import sys
from collections.abc import Sequence
from importlib import metadata
from typing import Any

from voltcam_client import cli_biases, cli_dv, cli_keys, cli_listen, cli_record, cli_ros1, cli_status

SUMMARIES = {
    "serve": "run the camera: live video in, events out",
    "replay": "play a recording as a live camera, or verify how it was made",
    "convert": "turn a video, images or a recording into an event file",
    "dataset": "make a data set of events from videos and images, verify it, look at it",
    "calibrate": "find a camera's parameters from a recording of it",
    "diagnose": "find, name and add what a camera file lacks to explain a recording",
    "evaluate": "hold models against recordings; the paper's figures and tables",
    "bench": "measure the speed on this machine, beside its own limits",
    "doctor": "say what works here: devices, codecs, ports, and for how many pixels the speed is enough",
    "config": "check a configuration file before it is used",
    "schema": "print the JSON schema of the configuration file, for editors",
}
OWN_COMMANDS = {
    "listen": ("print the rates, losses and latency of a running camera", cli_listen.configure),
    "record": ("record a running camera into a file", cli_record.configure),
    "status": ("print what a running daemon says of itself", cli_status.configure),
    "biases": (
        "print, set, save or load the biases of a running camera, as of a DAVIS",
        cli_biases.configure,
    ),
    "dv": ("run a program of dv-processing on the emulator", cli_dv.configure),
    "ros1": ("publish a running camera to ROS 1", cli_ros1.configure),
    "keys": ("make keys that open a camera's stream to few", cli_keys.configure),
}


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
