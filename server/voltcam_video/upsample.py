"""Frames between frames: what a source shows of a scene that never stops."""

from collections.abc import Iterable, Iterator
from itertools import chain
from typing import Literal

from voltcam_video.cubic import along_cubic
from voltcam_video.flow import along_flow
from voltcam_video.frame import Frame
from voltcam_video.interval import follows

Upsampling = Literal["linear", "cubic", "auto"] | int


def between(frames: Iterable[Frame], how: Upsampling) -> Iterator[Frame]:
    """The frames as they are, and float32 frames between them, in order of time.

    linear: none, for a simulator that draws straight lines in ln L between frames itself.
    cubic: each pixel's ln L on a monotone cubic; a frame comes when the next one is there.
    auto: along the motion, in as many steps as keep it below a pixel, 12 at most. A number: so many steps.

    There is nothing between frames at a cut, where time does not advance or the size changes; where the light
    goes on or off (auto); between images with a side below 32 pixels (auto and numbers). Raises ValueError.
    """
    if how == "linear":
        return iter(frames)
    if how == "cubic":
        return _eased(frames)
    if how == "auto":
        return _moved(frames, None)
    if not isinstance(how, int) or how < 1:
        raise ValueError(f"no way to upsample: {how!r}; give linear, cubic, auto or a number of steps from 1")
    return _moved(frames, how)


def _moved(frames: Iterable[Frame], steps: int | None) -> Iterator[Frame]:
    former: Frame | None = None
    for frame in frames:
        if former is not None and follows(former, frame):
            yield from along_flow(former, frame, steps)
        yield frame
        former = frame


def _eased(frames: Iterable[Frame]) -> Iterator[Frame]:
    before: Frame | None = None
    former: Frame | None = None
    frame: Frame | None = None
    for after in chain(frames, [None]):
        joined = after is not None and frame is not None and follows(frame, after)
        if frame is not None:
            if former is not None:
                yield from along_cubic(before, former, frame, after if joined else None)
            yield frame
        before, former, frame = (former, frame, after) if joined else (None, None, after)
