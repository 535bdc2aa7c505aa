"""The time of a camera, which runs on across cuts and changes of source."""

from typing import NamedTuple

PATIENCE_FRAMES = 10  # so many stamps in a row that do not advance mean that the source's clock was set back
FIRST_PERIOD_US = 33_333


class FrameTime(NamedTuple):
    """Of a frame. span_us: since the last one. cut: it does not follow from that one."""

    t_us: int
    span_us: int
    cut: bool


class CameraTime:
    """Where on it frames are. One that starts again at an earlier time is moved to one frame period after the
    last one, and those after it likewise.

    last_us: the time of the last frame, None before the first. shift_us: what is added to the source's
    times. period_us: of frames, as last seen. out_of_order: frames whose time did not advance.
    """

    def __init__(self) -> None:
        self.last_us: int | None = None
        self.shift_us = 0
        self.period_us = FIRST_PERIOD_US
        self.out_of_order = 0
        self._stuck = 0

    def place(self, source_us: int, cut: bool) -> FrameTime | None:
        """Of a frame by its source's time; None for one that is out of order, which is counted."""
        t_us = source_us + self.shift_us
        if self.last_us is None:
            return FrameTime(t_us, 0, True)
        span_us = t_us - self.last_us
        if not cut and span_us <= 0:
            self._stuck += 1
            if self._stuck <= PATIENCE_FRAMES:
                self.out_of_order += 1
                return None
            cut = True
        return FrameTime(t_us, span_us, cut)

    def restart(self, source_us: int) -> int:
        """The time of a frame that does not follow from the last one."""
        self.shift_us = 0  # where time goes on by itself: cameras on one clock must stay on it
        if self.last_us is not None and source_us <= self.last_us:
            self.shift_us = self.last_us + self.period_us - source_us
        return source_us + self.shift_us

    def went_on(self, t_us: int) -> None:
        """A frame of this time is the last one now."""
        self.last_us = t_us
        self._stuck = 0
