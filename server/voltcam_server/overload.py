"""More to simulate than there is time: the bounds of one interval, and how long intervals take."""

import math
import time

from pydantic import BaseModel, ConfigDict, Field

from voltcam_simulator import GivenUpError, TooManyEventsError

MOST_STEPS = 512
MOST_PIXEL_STEPS = 30e6  # about a second of one core
RECENT_S = 2.0
TOO_FAST = "frames come faster than they are simulated, and some are dropped"
MISSED_AT_LEAST = 2  # dropped frames, of which what was between is skipped
MOST_PERIODS = 2  # of frames, that simulating it may take: on a machine that was late for once it is not
BUSY = "frames are dropped while this machine is busy with something else: close other programs"


class OverloadSettings(BaseModel):
    """Bounds of what is simulated at a time; what lies beyond is skipped, and time goes on."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    longest_interval_us: int = Field(
        default=1_000_000,
        ge=1000,
        le=3_600_000_000,
        description="a longer time between two frames is skipped: the next events are those after it",
    )
    most_events: int = Field(
        default=8_000_000,
        ge=10_000,
        le=1_000_000_000,
        description="between two frames; an interval of more is skipped. An event needs up to 100 bytes of "
        "memory while it is made and sent",
    )
    longest_work_s: float = Field(
        default=2.0,
        ge=0.01,
        le=3600,
        description="an interval that takes longer to simulate is given up and skipped",
    )

    def words(self, error: GivenUpError) -> str:
        """Why an interval was given up."""
        if isinstance(error, TooManyEventsError):
            return f"more than {self.most_events} events between two frames"
        return f"one interval takes more than {self.longest_work_s:g} s"


def coarser(span_us: float, longest_step_us: float, pixels: int) -> float:
    """How many times longer steps must be, so that an interval has no more of them than can be simulated."""
    most = max(1.0, min(MOST_STEPS, MOST_PIXEL_STEPS // pixels))
    return max(1.0, span_us / longest_step_us / most) if math.isfinite(longest_step_us) else 1.0


class Load:
    """The time that simulating takes beside the time it is for, over the last intervals."""

    def __init__(self) -> None:
        self._ratio = 0.0
        self._periods = 0.0
        self._trouble = ("", 0.0, -math.inf)

    def worked(self, took_s: float, span_us: float, missed: int = 0) -> None:
        """An interval has been simulated, within which so many frames were dropped."""
        now = 1e6 * took_s / max(span_us, 1.0)
        self._ratio = _recent(self._ratio, now)
        self._periods = _recent(self._periods, now * (1 + missed))

    def skipped(self, why: str) -> None:
        """Something was left out just now."""
        self._trouble = (why, self._ratio, time.monotonic())

    def too_much(self, span_us: int, missed: int, settings: OverloadSettings) -> str:
        """Why an interval within which so many frames were dropped is not simulated; empty when it is."""
        if missed >= MISSED_AT_LEAST and (1 + missed) * self._ratio > MOST_PERIODS:
            return TOO_FAST
        if span_us > settings.longest_interval_us:
            return f"{span_us / 1e6:.3g} s between two frames, more than overload.longest_interval_us allows"
        return ""

    def dropped(self) -> None:
        """Frames were left out just now, for want of time."""
        self.skipped(TOO_FAST if self._periods > 1 else BUSY)

    @property
    def ratio(self) -> float:
        """1: all the time that there is; more: so many times too much for this machine."""
        return self._ratio

    @property
    def trouble(self) -> str:
        """Why something was left out in the last seconds; empty when nothing was."""
        why, _, at_s = self._trouble
        return why if time.monotonic() - at_s < RECENT_S else ""

    @property
    def words(self) -> str:
        """The same, with the load of then: it may be over by now."""
        return f"{self.trouble}; the load was {self._trouble[1]:.3g}" if self.trouble else ""


def _recent(before: float, now: float) -> float:
    """The mean of the last few; before: 0, there was none."""
    return before + 0.2 * (now - before) if before else now
