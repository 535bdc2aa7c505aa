"""Signals that only set a flag, and a line that is rewritten."""

import io
import os
import signal
import sys

import pytest

from voltcam_client import terminal
from voltcam_client.terminal import SHOW_PERIOD_S, live_line, until_signal


def test_a_signal_sets_the_flag_and_does_no_more() -> None:
    before = signal.getsignal(signal.SIGUSR1), signal.getsignal(signal.SIGUSR2)
    with until_signal(signal.SIGUSR1, signal.SIGUSR2) as stopped:
        assert not stopped.is_set()
        os.kill(os.getpid(), signal.SIGUSR2)
        assert stopped.wait(10)
    assert (signal.getsignal(signal.SIGUSR1), signal.getsignal(signal.SIGUSR2)) == before


def test_handlers_are_put_back_after_an_error() -> None:
    before = signal.getsignal(signal.SIGUSR1)
    within = []

    def fail() -> None:
        with until_signal(signal.SIGUSR1):
            within.append(signal.getsignal(signal.SIGUSR1))
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert within[0] is not before
    assert signal.getsignal(signal.SIGUSR1) is before


class Terminal(io.StringIO):
    """Standard error that is a terminal, or says so."""

    def isatty(self) -> bool:
        return True


class FakeTime:
    """A clock that stands."""

    now_s = 100.0

    def monotonic(self) -> float:
        return self.now_s


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> FakeTime:
    time = FakeTime()
    monkeypatch.setattr(terminal, "time", time)
    return time


def test_the_line_is_rewritten_a_few_times_a_second(clock: FakeTime, monkeypatch: pytest.MonkeyPatch) -> None:
    shown = Terminal()
    monkeypatch.setattr(sys, "stderr", shown)
    with live_line() as show:
        for step in range(5):
            show(lambda step=step: f"step {step}")  # type: ignore[misc]
            clock.now_s += 0.6 * SHOW_PERIOD_S
        assert shown.getvalue() == "".join(f"\r\033[Kstep {step}" for step in (0, 2, 4))
    assert shown.getvalue().endswith("step 4\r\033[K")


def test_nothing_shown_nothing_wiped(clock: FakeTime, monkeypatch: pytest.MonkeyPatch) -> None:
    shown = Terminal()
    monkeypatch.setattr(sys, "stderr", shown)
    with live_line():
        pass
    assert shown.getvalue() == ""


def test_without_a_terminal_the_text_is_not_even_made(
    clock: FakeTime, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = io.StringIO()
    monkeypatch.setattr(sys, "stderr", shown)
    with live_line() as show:
        show(lambda: pytest.fail("nobody sees it"))
    assert shown.getvalue() == ""
