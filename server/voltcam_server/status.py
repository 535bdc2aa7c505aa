"""What the daemon says about itself: `GET /status`, the `status` topic and `/metrics`."""

import time
from typing import Any, Literal

from pydantic import BaseModel

from voltcam_video import SourceRequest

from .recorder import RecordingStatus
from .transports import TransportStatus


class SourceStatus(BaseModel):
    """The source: what was asked for (a stream's password left out), what it turned out to be, how it is.

    fps: frames that came over the last second. position_s: in a recording, after its first frame.
    """

    uri: str
    request: SourceRequest
    state: Literal["opening", "running", "reconnecting", "ended"]
    message: str
    granted: dict[str, Any] | None
    fps: float
    position_s: float | None


class FrameCounts(BaseModel):
    """received = simulated + dropped + skipped + out_of_order + unusable, but for those under way.

    dropped: not looked at because newer ones were there. skipped: gone on from, without events up to them,
    since these would have been too many or of too long a time.
    out_of_order: their time did not advance. unusable: their values are no grey levels.
    """

    received: int
    simulated: int
    dropped: int
    skipped: int
    out_of_order: int
    unusable: int


class Total(BaseModel):
    """A count since the start, and its rate over the last second."""

    total: int
    per_s: float


class Latency(BaseModel):
    """Of the newest interval, from the arrival of the frame that ends it: to its events being known, and to
    the last of them leaving. age_ms: of what is being sent now, and of what is waited for in a stall."""

    simulated_ms: float
    sent_ms: float
    age_ms: float


State = Literal["starting", "running", "overloaded", "stalled", "source lost", "ended"]


class Waiting(BaseModel):
    """What waits: frames for the simulation, intervals to leave, intervals to be written into a recording."""

    frames: int
    intervals: int
    recording: int


class Status(BaseModel):
    """All of it.

    state, reason: how the daemon is, and in one line why where that is not "running". overloaded: something
    was left out in the last seconds; stalled: no interval has been finished for seconds.
    load: the time that simulating takes beside the time it is for; 2 means twice too much for this machine.
    skipped_us: the time that no events were made of. stalls, recording_errors: since the start.
    """

    state: State
    reason: str
    load: float
    skipped_us: int
    source: SourceStatus
    frames: FrameCounts
    events: Total
    packets: Total
    latency: Latency
    parameters_version: int
    uptime_s: float
    transports: dict[str, TransportStatus]
    recording: RecordingStatus | None
    waiting: Waiting
    stalls: int
    recording_errors: int


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
