"""How light goes from frame to frame, and the pixels of a sensor along it, in steps that effects ask for."""

import math
from collections.abc import Callable, Iterator, Sequence

from numpy.typing import ArrayLike

from .effect import Image
from .event_key import TIME_BITS
from .limits import Limits
from .pixel_array import PixelArray, nothing
from .sensor_pixels import SensorPixels

LONGEST_INTERVAL_US = 2**TIME_BITS - 1


class LightPath:
    """That of a sensor's pixels. image, t_us: the last frame and its time, None and 0 before the first."""

    def __init__(self, pixels: SensorPixels) -> None:
        self._pixels = pixels
        self.image: Image | None = None
        self.t_us = 0

    def follow(
        self, image: Image, t_us: int, start_us: int, limits: Limits, meanwhile: Callable[[], None] = nothing
    ) -> None:
        """Take the pixels to the next frame, which is not the last one yet; events are timed from start_us.

        meanwhile: as of `Simulator.draw`. Raises ValueError, with nothing changed; GivenUpError, somewhere on
        the way.
        """
        assert self.image is not None
        span_us = span_between(self.t_us, t_us, start_us)
        self._pixels.limits = limits
        self._pixels.look(self.image, image, float(span_us))
        self._steps(self.image, image, start_us, span_us, limits.coarser, meanwhile)

    def follow_all(self, frames: Iterator[tuple[ArrayLike, int]], start_us: int, limits: Limits) -> None:
        """Take the pixels along frames, several at once where they can be. Where one goes wrong, all before
        it have been followed."""
        most = self._pixels.most_at_once if isinstance(self._pixels, PixelArray) else 1
        seen: list[tuple[Image, int]] = []  # and not followed yet
        try:
            for frame, t_us in frames:
                image, last_us = self._pixels.image(frame), seen[-1][1] if seen else self.t_us
                span_between(last_us, t_us, start_us)
                seen.append((image, t_us))
                if len(seen) >= most:
                    several, seen = seen, []
                    self._follow_several(several, start_us, limits)
        finally:
            self._follow_several(seen, start_us, limits)

    def _follow_several(self, frames: Sequence[tuple[Image, int]], start_us: int, limits: Limits) -> None:
        if len(frames) == 1:
            self.follow(*frames[0], start_us, limits)
        elif frames:
            assert isinstance(self._pixels, PixelArray)
            images, times_us = zip(*frames, strict=True)
            self._pixels.limits = limits
            self._pixels.steps_at_once(images, times_us, self.t_us, start_us)
        if frames:
            self.image, self.t_us = frames[-1]

    def _steps(
        self, before: Image, after: Image, start_us: int, span_us: int, coarser: float,
        meanwhile: Callable[[], None],
    ) -> None:  # fmt: skip
        """The interval in steps that are short enough for every effect; light goes in a straight line."""
        steps = min(max(1, math.ceil(span_us / (self._pixels.longest_step_us * coarser))), span_us)
        begin, offset = 0, self.t_us - start_us
        for step in range(1, steps + 1):
            end = span_us * step // steps  # whole microseconds, so that effects agree on where steps meet
            share, span = (end / span_us if step < steps else 1.0), float(end - begin)
            self._pixels.step(before, after, share, start_us, float(offset + begin), span, meanwhile)
            begin, meanwhile = end, nothing


def span_between(last_us: int, t_us: int, start_us: int) -> int:
    """The time from the last frame to this one. Raises ValueError where it does not advance, or where an
    interval from start_us is too long."""
    if t_us <= last_us:
        raise ValueError(f"the frame at {t_us} us does not come after the last one at {last_us} us")
    if (whole_us := t_us - start_us) > LONGEST_INTERVAL_US:
        raise ValueError(f"{whole_us / 3.6e9:.0f} hours between two frames: at most 38 are possible")
    return t_us - last_us
