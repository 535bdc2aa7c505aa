"""What goes to the log: one line for each change of state, and now and then one with the rates."""

import logging
import time

from .log import LogSettings, log
from .status import Status


class StatusLog:
    """Looks at each status of a camera: what has changed since the last one is a line.

    camera: its name, for a daemon that has several.
    """

    def __init__(self, settings: LogSettings, camera: str = "") -> None:
        self._rates_s = settings.rates_s
        self._extra = {"camera": camera} if camera else {}
        self._head = f"{camera}: " if camera else ""
        self._state, self._source, self._error = "starting", "", ""
        self._told_s = time.monotonic()

    def look(self, status: Status) -> None:
        """Say what is new."""
        if (status.state, status.source.uri) != (self._state, self._source):
            well = status.state in ("starting", "running")
            words = f"{self._head}{status.state}: {status.reason or status.source.uri}"
            if self._state != "starting" or not well:  # the beginning is on the banner
                log.log(
                    logging.INFO if well else logging.WARNING,
                    words,
                    extra={"state": status.state, **self._extra},
                )
            self._state, self._source = status.state, status.source.uri
        error = (status.recording.error or "") if status.recording else ""
        if error != self._error:
            self._error = error
            if error:
                log.error("%srecording: %s", self._head, error, extra=self._extra)
        now_s = time.monotonic()
        if self._rates_s and now_s - self._told_s >= self._rates_s:
            self._told_s = now_s
            self._tell_rates(status)

    def _tell_rates(self, status: Status) -> None:
        frames = status.frames
        rates = {
            "events_per_s": status.events.per_s,
            "fps": status.source.fps,
            "load": status.load,
            "age_ms": status.latency.age_ms,
            "dropped": frames.dropped,
            "skipped": frames.skipped,
        }
        words = " ".join(f"{name}={value:.6g}" for name, value in rates.items())
        log.info(self._head + words, extra={**rates, **self._extra})
