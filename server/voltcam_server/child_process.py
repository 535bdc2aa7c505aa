"""A process beside the daemon, at a lower priority."""

import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from .problems import UsageError

# The kernel ends it when its parent is gone, also by kill -9; the parent may have gone before it asked.
BEGIN = """
import ctypes, os, signal, sys
ctypes.CDLL(None).prctl(1, signal.SIGTERM)  # PR_SET_PDEATHSIG
if os.getppid() != int(sys.argv[1]): sys.exit(1)
os.nice(int(sys.argv[2]))
os.execvp(sys.argv[3], sys.argv[3:])
"""


class ChildProcess:
    """Runs `command`, `nice` by 0 to 19; what it says on standard error goes to the file `log`.

    It ends with the thread that made it, which must follow it to its end, and so with the daemon.
    It has a process group of its own, so that all of it can be ended, but no session: with Linux's autogroups
    priorities would count inside that session only.
    """

    def __init__(self, command: Sequence[str], nice: int, log: Path) -> None:
        self._log = log
        with log.open("w") as errors:
            self._process = subprocess.Popen(
                [sys.executable, "-c", BEGIN, str(os.getpid()), str(nice), *command],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=errors,
                encoding="utf-8",
                errors="replace",
                process_group=0,
            )

    def follow(self, hear: Callable[[str], None]) -> None:
        """Until it ends, `hear` each line. Raises UsageError, with the last thing it said, when it fails."""
        with self._process as process:
            assert process.stdout is not None
            for line in process.stdout:
                hear(line.rstrip())
        if process.returncode:
            raise UsageError(self._complaint())

    def signal(self, number: signal.Signals) -> None:
        """To all of it; from any thread."""
        if self._process.poll() is None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self._process.pid, number)

    def _complaint(self) -> str:
        said = [line for line in self._log.read_text(errors="replace").split("\n") if line.strip()]
        last = said[-1] if said else f"it ended with status {self._process.returncode}"
        told = last.removeprefix("voltcam: ")  # an error of the user's; anything else is one of ours
        return told if told != last else f"the diagnosis failed: {last}: please report it, with {self._log}"
