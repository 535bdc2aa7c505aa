"""What the daemon says about itself: `GET /status`, the `status` topic and `/metrics`."""

import time
from typing import Any, Literal

from pydantic import BaseModel

from voltcam_video import SourceRequest

from .recorder import RecordingStatus
from .transports import TransportStatus


class SourceStatus(BaseModel):
    """The source: what was asked for (a stream's password left out), what it turned out to be, how it is.

    fps: frames that came over the last second.
    """

    uri: str
    request: SourceRequest
    state: Literal["opening", "running", "reconnecting", "ended"]
    message: str
    granted: dict[str, Any] | None
    fps: float


class FrameCounts(BaseModel):
    """received = simulated + dropped + out_of_order + unusable, but for those under way.

    dropped: skipped because a newer one was there, up to which the simulation takes coarser steps.
    out_of_order: their time did not advance. unusable: their values are no grey levels.
    """

    received: int
    simulated: int
    dropped: int
    out_of_order: int
    unusable: int


class Total(BaseModel):
    """A count since the start, and its rate over the last second."""

    total: int
    per_s: float


class Latency(BaseModel):
    """Of the newest interval, from the arrival of the frame that ends it: to its events being known, and to
    the last of them leaving."""

    simulated_ms: float
    sent_ms: float


class Status(BaseModel):
    """All of it."""

    source: SourceStatus
    frames: FrameCounts
    events: Total
    packets: Total
    latency: Latency
    parameters_version: int
    uptime_s: float
    transports: dict[str, TransportStatus]
    recording: RecordingStatus | None


class Meter:
    """A count with its rate over the time between the last two ticks. One thread counts, one ticks."""

    def __init__(self) -> None:
        self.total = 0
        self._per_s = 0.0
        self._ticked = (time.monotonic(), 0)

    def tick(self) -> None:
        now_s, total = time.monotonic(), self.total
        then_s, before = self._ticked
        if now_s > then_s:
            self._per_s = (total - before) / (now_s - then_s)
            self._ticked = (now_s, total)

    @property
    def status(self) -> Total:
        return Total(total=self.total, per_s=round(self._per_s, 3))
