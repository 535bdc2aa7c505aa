"""What the daemon says about itself: `GET /status`, the `status` topic and `/metrics`."""

import time
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

from voltcam_video import SourceRequest

from .recorder import RecordingStatus
from .transports import TransportStatus


class SourceStatus(BaseModel):
    """What a camera looks at: what was asked for, what it turned out to be, how it is."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    uri: str
    """as it was asked for; a stream's password is left out"""

    request: SourceRequest
    """all that was asked for"""

    state: Literal["opening", "waiting", "running", "reconnecting", "ended"]
    """how it is; waiting: for a program that is to send the first frame"""

    message: str
    """why, in one line, where it is not running"""

    granted: dict[str, Any] | None
    """size, rate and format that came; null before the first frame"""

    fps: float
    """frames that came over the last second, 1/s"""

    position_s: float | None
    """in a recording, seconds after its first frame; null elsewhere"""


class FrameCounts(BaseModel):
    """received = simulated + dropped + skipped + out_of_order + unusable, but for those under way."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    received: int
    """from the source"""

    simulated: int
    """looked at, up to the events"""

    dropped: int
    """not looked at, because newer ones were there; of a topic also those lost on the way, or unfit"""

    skipped: int
    """gone on from, without events up to them: these would have been too many, or of too long a time"""

    out_of_order: int
    """their time did not advance"""

    unusable: int
    """their values are no grey levels"""


class Total(BaseModel):
    """A count and its rate."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    total: int
    """since the start"""

    per_s: float
    """over the last second, 1/s"""


class LatencyStatus(BaseModel):
    """Of the newest interval, from the arrival of the frame that ends it."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    simulated_ms: float
    """until its events were known, ms"""

    sent_ms: float
    """until the last of them left, ms"""

    age_ms: float
    """of what is being sent now, and of what is waited for in a stall, ms"""


State = Literal["starting", "running", "overloaded", "stalled", "source lost", "ended"]


class Waiting(BaseModel):
    """What waits."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    frames: int
    """for the simulation"""

    intervals: int
    """to leave"""

    recording: int
    """intervals to be written into a recording"""


class Status(BaseModel):
    """How a camera is.

    Overloaded: something was left out in the last seconds. Stalled: no interval was finished for seconds.
    """

    model_config = ConfigDict(use_attribute_docstrings=True)

    state: State
    """how the camera is"""

    reason: str
    """why, in one line, where it is not running"""

    load: float
    """time that simulating takes beside the time it is for; 2 is twice too much for this machine"""

    skipped_us: int
    """time that no events were made of, us"""

    source: SourceStatus
    """what it looks at"""

    frames: FrameCounts
    """since the start"""

    events: Total
    """that were made"""

    packets: Total
    """that were made"""

    latency: LatencyStatus
    """of the newest interval"""

    parameters_version: int
    """that of the packets that are made now"""

    uptime_s: float
    """since the start, s"""

    transports: dict[str, TransportStatus]
    """by name: zeromq, websocket, dv, ros2"""

    recording: RecordingStatus | None
    """the one that runs, or has ended by itself; null where there is none"""

    waiting: Waiting
    """between the parts of the daemon"""

    stalls: int
    """since the start"""

    recording_errors: int
    """since the start"""


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
