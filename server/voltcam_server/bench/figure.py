"""A figure of `voltcam bench`: what was measured several times, as a line of its table."""

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Frames = NDArray[np.uint8]
REPEATS = 5


MORE_IS_BETTER = ("Mpx/s", "GB/s", "times", "Mevents/s", "pictures/s")
"""Units; of all others less is better."""


@dataclass
class Figure:
    """One line of the table: a median, its spread, what it is measured in, and what to hold it against."""

    name: str
    median: float
    least: float
    most: float
    unit: str
    remark: str = ""

    @classmethod
    def of(cls, name: str, values: list[float], unit: str, remark: str = "") -> "Figure":
        return cls(name, statistics.median(values), min(values), max(values), unit, remark)

    def __str__(self) -> str:
        figures = f"{self.median:10.4g}   {self.least:9.4g} to {self.most:<9.4g}"
        return f"{self.name:<46}{figures} {self.unit:<14} {self.remark}".rstrip()

    def beside(self, old: "Figure") -> str:
        """The line, and the median of an older run with how many times better this one is."""
        better = self.median / old.median if old.median else float("nan")
        if self.unit not in MORE_IS_BETTER:
            better = 1 / better if better else float("nan")
        figures = f"{self.median:10.4g}   was {old.median:<9.4g} {self.unit:<14}"
        return f"{self.name:<46}{figures} {better:.2f} times as good"


def repeated(
    action: Callable[[], object], repeats: int = REPEATS, clock: Callable[[], float] = time.perf_counter
) -> list[float]:
    """Seconds of each run, by wall time unless another clock is given."""
    seconds = []
    for _ in range(repeats):
        begin = clock()
        action()
        seconds.append(clock() - begin)
    return seconds
