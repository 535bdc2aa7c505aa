"""What a sensor has seen before a recording begins."""

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from typing import Any

from numpy.typing import NDArray

Image = NDArray[Any]


def run_up(
    images: Sequence[Image] | Image, times_us: Sequence[int], lead_in_us: int, there_us: int = 0
) -> Iterator[tuple[Image, int]]:
    """What comes before the first of the images, with times: what comes after it, backwards.

    A scene that moves has moved before, and voltages tell of that until a pixel's first event. there_us: the
    camera has been there for so long at least, and has seen a still scene before.
    """
    begin_us = times_us[0]
    last = bisect_right(times_us, begin_us + lead_in_us) - 1
    yield images[last], min(2 * begin_us - times_us[last] - 1, begin_us - there_us)
    for k in range(last, 0, -1):
        yield images[k], 2 * begin_us - times_us[k]
