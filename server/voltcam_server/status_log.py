"""What goes to the log: one line for each change of state, and now and then one with the rates."""

import logging
import time

from .log import LogSettings, log
from .status import Status


class StatusLog:
    """Looks at each status: what has changed since the last one is a line."""

    def __init__(self, settings: LogSettings) -> None:
        self._rates_s = settings.rates_s
        self._state, self._source, self._error = "starting", "", ""
        self._told_s = time.monotonic()

    def look(self, status: Status) -> None:
        """Say what is new."""
        if (status.state, status.source.uri) != (self._state, self._source):
            well = status.state in ("starting", "running")
            words = f"{status.state}: {status.reason or status.source.uri}"
            if self._state != "starting" or not well:  # the beginning is on the banner
                log.log(logging.INFO if well else logging.WARNING, words, extra={"state": status.state})
            self._state, self._source = status.state, status.source.uri
        error = (status.recording.error or "") if status.recording else ""
        if error != self._error:
            self._error = error
            if error:
                log.error("recording: %s", error)
        now_s = time.monotonic()
        if self._rates_s and now_s - self._told_s >= self._rates_s:
            self._told_s = now_s
            self._tell_rates(status)

    @staticmethod
    def _tell_rates(status: Status) -> None:
        frames = status.frames
        rates = {
            "events_per_s": status.events.per_s,
            "fps": status.source.fps,
            "load": status.load,
            "age_ms": status.latency.age_ms,
            "dropped": frames.dropped,
            "skipped": frames.skipped,
        }
        log.info(" ".join(f"{name}={value:.6g}" for name, value in rates.items()), extra=rates)
