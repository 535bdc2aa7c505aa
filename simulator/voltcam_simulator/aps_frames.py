"""The frames of a DAVIS: the light of each exposure, at the times that `aps_coupling` has.

Light goes in a straight line from one source frame to the next, as it does for events, and a frame is its
mean over the exposure, which all rows share. Images are of light, as `InputResponse.light_of` has it.
There is no noise of an APS pixel, and a longer exposure is no brighter.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .effects.aps_coupling import NS_PER_US, ApsCoupling

Image = NDArray[Any]


class ApsFrame(NamedTuple):
    """image: (height, width) uint8. exposure_us, frame_us: begin and end, the frame's with both readouts."""

    image: NDArray[np.uint8]
    exposure_us: tuple[int, int]
    frame_us: tuple[int, int]


@dataclass(slots=True)
class _Exposure:
    """One under way: the light so far times its time."""

    frame_ns: int
    begin_ns: int
    end_ns: int
    light: NDArray[np.float32]


class ApsFrames:
    """Of a sensor that is so many rows high. `jump` to its first source frame, then `advance`."""

    def __init__(self, height: int) -> None:
        self._height = height
        self._former: tuple[Image, int] | None = None
        self._exposure: _Exposure | None = None
        self._coupling: ApsCoupling | None = None

    def jump(self, image: Image, t_us: int) -> None:
        """Go on from a source frame that does not follow from the last one; what is exposed then is lost."""
        self._former, self._exposure = (image, t_us), None

    def advance(self, coupling: ApsCoupling, image: Image, t_us: int) -> list[ApsFrame]:
        """The frames whose exposures end after the last source frame, and up to this one."""
        if self._former is None:
            self.jump(image, t_us)
            return []
        if coupling != self._coupling:
            self._coupling, self._exposure = coupling, None
        former, former_us = self._former
        self._former = image, t_us
        span = (former_us * NS_PER_US, t_us * NS_PER_US)
        frames = []
        for exposure in self._exposures(coupling, *span):
            _expose(exposure, former.astype(np.float32), image.astype(np.float32), *span)
            if exposure.end_ns <= span[1]:
                frames.append(self._frame(coupling, exposure))
                self._exposure = None
            else:
                self._exposure = exposure
        return frames

    def _exposures(self, coupling: ApsCoupling, begin_ns: int, end_ns: int) -> Iterator[_Exposure]:
        """Those that are in a span, the one under way first."""
        if self._exposure is not None:
            yield self._exposure
        times = coupling.times(self._height)
        number = -((times.begin_ns + times.exposed_ns - begin_ns) // times.period_ns)
        while (frame := times.begin_ns + number * times.period_ns) + times.exposed_ns < end_ns:
            light = np.zeros((self._height, self._width), np.float32)
            yield _Exposure(frame, frame + times.exposed_ns, frame + times.read_ns, light)
            number += 1

    @property
    def _width(self) -> int:
        assert self._former is not None
        return int(self._former[0].shape[1])

    def _frame(self, coupling: ApsCoupling, exposure: _Exposure) -> ApsFrame:
        mean = exposure.light / (exposure.end_ns - exposure.begin_ns)
        end_ns = exposure.frame_ns + coupling.times(self._height).end_ns
        return ApsFrame(
            np.clip(np.rint(mean), 0, 255).astype(np.uint8),
            (exposure.begin_ns // NS_PER_US, exposure.end_ns // NS_PER_US),
            (exposure.frame_ns // NS_PER_US, end_ns // NS_PER_US),
        )


def _expose(
    exposure: _Exposure, former: NDArray[np.float32], image: NDArray[np.float32], begin_ns: int, end_ns: int
) -> None:
    """Add the light that falls into the exposure while it goes from `former` to `image`."""
    first, last = max(begin_ns, exposure.begin_ns), min(end_ns, exposure.end_ns)
    middle = np.float32(
        (first + last - 2 * begin_ns) / (2 * (end_ns - begin_ns))
    )  # the mean of a straight line
    exposure.light += (former + middle * (image - former)) * np.float32(last - first)
