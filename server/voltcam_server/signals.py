"""Ctrl-C and SIGTERM, which end what runs in good order; SIGHUP, which has the settings read again."""

import contextlib
import logging
import signal
import threading
from collections.abc import Callable, Iterator

from .problems import UsageError, one_line
from .reload import ReloadAnswer


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


@contextlib.contextmanager
def reloaded_by_signal(reload: Callable[[], ReloadAnswer]) -> Iterator[None]:
    """Inside, SIGHUP calls `reload` in a thread of its own, and what comes of it is logged."""
    log = logging.getLogger(__name__)

    def run() -> None:
        try:
            log.info("settings read again: %s", reload().words)
        except UsageError as error:
            log.error("settings not taken: %s", one_line(error))

    def begin(*_: object) -> None:
        threading.Thread(target=run, name="voltcam-reload", daemon=True).start()

    former = signal.signal(signal.SIGHUP, begin)
    try:
        yield
    finally:
        signal.signal(signal.SIGHUP, former)
