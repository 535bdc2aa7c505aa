"""What a command does with the terminal that it runs in: Ctrl-C, and a line that is rewritten."""

import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

SHOW_PERIOD_S = 0.25


@contextmanager
def until_signal(*signals: signal.Signals) -> Iterator[threading.Event]:
    """Set by these signals, which then do no more than that: a write is not cut in two."""
    stopped = threading.Event()
    before = [signal.signal(number, lambda *_: stopped.set()) for number in signals]
    try:
        yield stopped
    finally:
        for number, handler in zip(signals, before, strict=True):
            signal.signal(number, handler)


@contextmanager
def live_line() -> Iterator[Callable[[Callable[[], str]], None]]:
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
