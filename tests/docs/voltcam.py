"""`voltcam` as the commands of a page are run: what it reads is there, what would run on ends by itself.

Inputs that are not there are made. Outputs may be there: a page shows one command in several ways. Daemons
listen on free ports, and end when they have begun. Clients that are given no address take that of the daemon
which the test runs: PAGES_ZMQ and PAGES_HTTP.
"""

import argparse
import io
import os
import signal
import sys
from pathlib import Path
from typing import TextIO

from tests.docs.commands import parse
from tests.docs.things import make

from voltcam_client import camera, control
from voltcam_client.cli import main

INPUTS = ("input", "recording", "file", "source", "camera", "config")
BEGUN, BY_CTRL_C = "Ctrl-C ends it", 130


class UntilItHasBegun(io.TextIOBase):
    """Standard output that ends a daemon when it says that it has begun."""

    def __init__(self, out: TextIO) -> None:
        self.out = out

    def write(self, text: str) -> int:
        if BEGUN in text:
            os.kill(os.getpid(), signal.SIGINT)
        return self.out.write(text)

    def flush(self) -> None:
        self.out.flush()


def run(arguments: list[str]) -> int:
    given = parse(arguments)
    for name in INPUTS:
        _there(given, name)
    camera.DEFAULT_URL = os.environ.get("PAGES_ZMQ", camera.DEFAULT_URL)
    control.DEFAULT_URL = os.environ.get("PAGES_HTTP", control.DEFAULT_URL)
    if "overwrite" in given:
        arguments = [*arguments, "--overwrite"]
    if arguments[0] == "serve" or (arguments[0] == "replay" and not given.verify):
        return _begin_and_end(arguments)
    return main(arguments)


def _begin_and_end(arguments: list[str]) -> int:
    """A daemon that begins has done what the page says, whether Ctrl-C finds it ready or not quite."""
    sys.stdout = UntilItHasBegun(sys.stdout)
    # Of an option that is given twice the last counts.
    status = main([*arguments, "--http", "127.0.0.1:0", "--zmq", "tcp://127.0.0.1:0"])
    return 0 if status == BY_CTRL_C else status


def _there(given: argparse.Namespace, name: str) -> None:
    value = getattr(given, name, None)
    for one in value if isinstance(value, list) else [value]:
        if one is not None and "://" not in str(one) and not Path(one).exists():
            make(Path(one))


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:]))
