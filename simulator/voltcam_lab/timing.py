"""How late a camera's events are, and for how long a pixel is held after one: by what explains them best."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .fit import maximise, named
from .intervals import Intervals
from .reading import Reading

DELAYS_US = np.arange(-4000.0, 12_001.0, 1000.0)
DEAD_US = np.concatenate([[0.0], 50 * 1.4 ** np.arange(18)])


def find_delay(sample: Reading, start: NDArray[np.float64]) -> float:
    """How late events are [us]; 0 where that explains them hardly worse. start: (k,) log parameters."""

    def score(delay_us: float) -> tuple[float, int]:
        return _mixture(sample.intervals(0.0, delay_us), 0.0, start)

    return _search(score, DELAYS_US)


def find_dead_time(sample: Reading, start: NDArray[np.float64], delay_us: float) -> float:
    """For how long pixels are held after an event [us]: hardly any interval is shorter."""
    pixel = sample.events["y"].astype(np.int64) * sample.scene.width + sample.events["x"]
    order = np.argsort(pixel, kind="stable")
    lengths = np.diff(sample.events["t"][order])[np.diff(pixel[order]) == 0]
    longest = float(np.quantile(lengths, 0.02)) if lengths.size else 0.0

    def score(dead_us: float) -> tuple[float, int]:
        return _mixture(sample.intervals(dead_us, delay_us), dead_us, start)

    return _search(score, DEAD_US[longest * 1.5 >= DEAD_US])


def _mixture(seen: Intervals, dead_us: float, start: NDArray[np.float64]) -> tuple[float, int]:
    """The log likelihood of an event, and how many there are."""
    x, likelihood = maximise(seen, dead_us, start, em_steps=1, steps=4)
    return likelihood.reweigh(named(x)) / max(likelihood.events, 1), likelihood.events


def _search(score: Callable[[float], tuple[float, int]], grid: NDArray[np.float64]) -> float:
    """Where `score` is highest, by the grid and four halvings about its best; 0 where that is hardly
    better."""
    scores = [score(float(x)) for x in grid]
    k = int(np.argmax([each for each, _ in scores]))
    best, top = float(grid[k]), scores[k][0]
    at_zero, events = scores[int(np.argmin(np.abs(grid)))]
    below, above = float(grid[max(k - 1, 0)]), float(grid[min(k + 1, len(grid) - 1)])
    for _ in range(4):
        tries = [0.5 * (below + best), 0.5 * (best + above)]
        values = [score(x)[0] for x in tries]
        if max(values) <= top:
            below, above = tries
        elif values[0] >= values[1]:
            best, top, above = tries[0], values[0], best
        else:
            best, top, below = tries[1], values[1], best
    gain = top - at_zero
    return best if gain > 0.005 and gain * events > 10 else 0.0
