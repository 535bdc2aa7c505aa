"""Ctrl-C and SIGTERM, which end what runs in good order."""

import contextlib
import signal
from collections.abc import Callable, Iterator


@contextlib.contextmanager
def ended_by_signal(end: Callable[[], None]) -> Iterator[None]:
    """Inside, SIGINT and SIGTERM call `end` and do no more than that. For the main thread."""
    signals = (signal.SIGINT, signal.SIGTERM)
    former = [signal.signal(number, lambda *_: end()) for number in signals]
    try:
        yield
    finally:
        for number, handler in zip(signals, former, strict=True):
            signal.signal(number, handler)
