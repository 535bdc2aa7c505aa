"""Signals to the daemon, in this process: the end in good order, and settings read again."""

import os
import signal
import threading

import pytest

from voltcam_server.problems import UsageError
from voltcam_server.reload import ReloadAnswer
from voltcam_server.signals import ended_by_signal, reloaded_by_signal

from .rig import until


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_calls_the_end_and_no_more(number: signal.Signals) -> None:
    former, ends = signal.getsignal(number), []
    with ended_by_signal(lambda: ends.append(1)):
        os.kill(os.getpid(), number)
        os.kill(os.getpid(), number)
        until(lambda: len(ends) == 2, "both are heard")
    assert signal.getsignal(number) is former


def test_handlers_are_put_back_after_an_error() -> None:
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    former = [signal.getsignal(number) for number in numbers]

    def fail() -> None:
        with ended_by_signal(lambda: None), reloaded_by_signal(ReloadAnswer):
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert [signal.getsignal(number) for number in numbers] == former


def test_sighup_reads_the_settings_again_in_another_thread(caplog: pytest.LogCaptureFixture) -> None:
    threads = []

    def reload() -> ReloadAnswer:
        threads.append(threading.current_thread())
        return ReloadAnswer(kept=["left"], changed=["right"])

    with caplog.at_level("INFO"), reloaded_by_signal(reload):
        os.kill(os.getpid(), signal.SIGHUP)
        until(lambda: caplog.records, "it is logged")
    assert threads[0] is not threading.main_thread()
    assert caplog.messages == ["settings read again: kept: left; changed: right"]


def test_settings_that_cannot_be_are_logged_in_a_line(caplog: pytest.LogCaptureFixture) -> None:
    def reload() -> ReloadAnswer:
        raise UsageError("voltcam.yaml: two\nlines")

    with caplog.at_level("INFO"), reloaded_by_signal(reload):
        os.kill(os.getpid(), signal.SIGHUP)
        until(lambda: caplog.records, "it is logged")
    assert [(record.levelname, record.getMessage()) for record in caplog.records] == [
        ("ERROR", "settings not taken: voltcam.yaml: two lines")
    ]
