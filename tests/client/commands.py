"""`voltcam` in a process of its own, and what its errors look like."""

import subprocess
import sys

COMMAND = [sys.executable, "-c", "import sys; from voltcam_client.cli import main; sys.exit(main())"]


def start(*args: str, prelude: str = "") -> subprocess.Popen[str]:
    command = [*COMMAND[:2], prelude + COMMAND[2], *args]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def assert_one_line(text: str, start: str = "voltcam: ") -> None:
    assert text.startswith(start)
    assert text.count("\n") == 1
