"""How late a camera's events are, and for how long a pixel is held after one: by what explains them best."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .fit import maximise, named, tiles
from .intervals import Intervals
from .reading import Reading

DELAYS_US = np.arange(-4000.0, 12_001.0, 1000.0)
DEAD_US = np.concatenate([[0.0], 50 * 1.4 ** np.arange(18)])
SURE = 2.5  # standard deviations from 0 that a time has to be
LEAST_GAIN = 0.02  # of log likelihood an event: errors of light between 25 frames a second gain up to 0.013
RESAMPLED = 200
SHORTEST = 0.005  # of the intervals between events may be shorter than the dead time: noise

Vector = NDArray[np.float64]
Profile = tuple[Vector, NDArray[np.int64]]


def find_times(
    sample: Reading, start: Vector, report: Callable[[str], None] = lambda step: None
) -> tuple[float, float]:
    """(how late events are, for how long pixels are held) [us], from log parameters (k,) to start at.

    What passes while a pixel is held makes events seem early: where it is held, both are looked for again.
    """
    report("delay")
    delay_us = find_delay(sample, start, 0.0)
    report("dead time")
    dead_us = find_dead_time(sample, start, delay_us)
    if dead_us:
        delay_us = find_delay(sample, start, dead_us)
        dead_us = find_dead_time(sample, start, delay_us)
    return delay_us, dead_us


def find_delay(sample: Reading, start: Vector, dead_us: float) -> float:
    """How late events are [us]; 0 where the recording does not tell it from that."""

    def profile(delay_us: float) -> Profile:
        return _profile(sample.intervals(dead_us, delay_us), dead_us, start, sample.scene.width)

    return _search(profile, DELAYS_US)


def find_dead_time(sample: Reading, start: Vector, delay_us: float) -> float:
    """For how long pixels are held after an event [us]: hardly any interval is shorter than that.

    0 where the recording does not tell.
    """
    pixel = sample.events["y"].astype(np.int64) * sample.scene.width + sample.events["x"]
    order = np.argsort(pixel, kind="stable")
    lengths = np.diff(sample.events["t"][order])[np.diff(pixel[order]) == 0]
    longest = float(np.quantile(lengths, SHORTEST)) if lengths.size else 0.0

    def profile(dead_us: float) -> Profile:
        return _profile(sample.intervals(dead_us, delay_us), dead_us, start, sample.scene.width)

    return _search(profile, DEAD_US[longest >= DEAD_US])


def _profile(seen: Intervals, dead_us: float, start: Vector, width: int) -> Profile:
    """The log likelihood of each interval, per event, and its tile of pixels."""
    x, likelihood = maximise(seen, dead_us, start, em_steps=1, steps=4)
    return likelihood.reweigh(named(x)) / max(likelihood.events, 1), tiles(likelihood.seen["pixel"], width)


def _search(profile: Callable[[float], Profile], grid: Vector) -> float:
    """Where the likelihood is highest, by the grid and three halvings about its best.

    0 unless that is where most of the picture has it: neighbours, and events of a pixel, see the same error
    of the light, so tiles of pixels are drawn anew to say how far off it may be (bootstrap by clusters, Efron
    and Tibshirani 1993).
    """
    found = dict(zip(grid.tolist(), (profile(x) for x in grid.tolist()), strict=True))
    width = int(max(tile.max(initial=0) for _, tile in found.values())) + 1

    def by_tile(one: Profile) -> Vector:
        return np.asarray(np.bincount(one[1], one[0], minlength=width), np.float64)

    scores = {x: by_tile(one) for x, one in found.items()}
    for _ in range(3):
        x = np.array(sorted(scores))
        k = int(np.argmax([scores[each].sum() for each in x]))
        for near in (max(k - 1, 0), min(k + 1, len(x) - 1)):
            if near != k:
                middle = float(x[k] + x[near]) / 2
                scores[middle] = by_tile(profile(middle))
    x = np.array(sorted(scores))
    table = np.stack([scores[each] for each in x])
    table = table[:, np.abs(table).sum(axis=0) > 0]
    rng = np.random.default_rng(0)
    tiles_drawn = rng.multinomial(table.shape[1], np.full(table.shape[1], 1 / table.shape[1]), RESAMPLED)
    spread = float(x[np.argmax(table @ tiles_drawn.T, axis=0)].std())
    best = float(x[np.argmax(table.sum(axis=1))])
    gain = table[np.argmax(table.sum(axis=1))].sum() - table[np.argmin(np.abs(x))].sum()
    return best if abs(best) > SURE * spread and gain > LEAST_GAIN else 0.0
