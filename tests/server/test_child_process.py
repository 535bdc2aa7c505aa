"""A process beside the daemon: heard, ended, and its complaint told in one line."""

import os
import signal
import sys
import threading
import time
from pathlib import Path

import pytest

from voltcam_server.child_process import ChildProcess
from voltcam_server.problems import UsageError


def test_a_child_asks_for_its_end_at_once(tmp_path: Path) -> None:
    child = ChildProcess(["sleep", "60"], 5, tmp_path / "log")
    following = threading.Thread(target=lambda: _follow(child))
    following.start()
    time.sleep(0.3)
    child.signal(signal.SIGTERM)
    following.join(10)
    assert not following.is_alive()


def _follow(child: ChildProcess) -> None:
    try:
        child.follow(lambda _: None)
    except UsageError:
        return


def python(code: str, log: Path, nice: int = 0) -> ChildProcess:
    return ChildProcess([sys.executable, "-S", "-c", code], nice, log)


def test_each_line_is_heard_as_it_comes(tmp_path: Path) -> None:
    lines: list[str] = []
    python("print('one'); print('tw\u00f6  '); print(); print('last', end='')", tmp_path / "log").follow(
        lines.append
    )
    assert lines == ["one", "twö", "", "last"]


def test_it_runs_at_the_priority_it_is_given_in_a_group_of_its_own(tmp_path: Path) -> None:
    lines: list[str] = []
    code = "import os; print(os.nice(0), os.getpgid(0) == os.getpid(), os.getsid(0))"
    python(code, tmp_path / "log", nice=3).follow(lines.append)
    nice, own_group, session = lines[0].split()
    assert int(nice) == min(os.nice(0) + 3, 19)
    assert own_group == "True"
    assert int(session) == os.getsid(0)


@pytest.mark.parametrize(
    ("code", "words"),
    [
        (
            "import sys; sys.exit('voltcam: walk.npz has no frames: record some')",
            "^walk.npz has no frames: re",
        ),
        ("raise KeyError('k7')", r"^the diagnosis failed: KeyError: 'k7': please report it, with .*log$"),
        ("import sys; sys.exit(7)", "^the diagnosis failed: it ended with status 7: please report"),
    ],
)
def test_why_it_failed_is_the_last_thing_it_said(code: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=words):
        python(code, tmp_path / "log").follow(lambda _: None)


def test_standard_error_is_in_the_log_and_not_heard(tmp_path: Path) -> None:
    lines: list[str] = []
    python("import sys; print('said'); print('logged', file=sys.stderr)", tmp_path / "log").follow(
        lines.append
    )
    assert lines == ["said"]
    assert (tmp_path / "log").read_text() == "logged\n"


def test_a_signal_to_one_that_is_over_does_no_harm(tmp_path: Path) -> None:
    child = python("", tmp_path / "log")
    child.follow(lambda _: None)
    child.signal(signal.SIGTERM)
