"""Which plane wave over the pixels is most like what a function of the place tells."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...dependence.covariates import LATTICE, LINES, PATCHES_ACROSS, PATCHES_DOWN
from ...dependence.told_apart import Telling

RIDGE = 0.02  # of all weight: no long wave takes the part of a constant

Array = NDArray[np.float64]


class PixelWave(NamedTuple):
    """Log ratios of the rates, on[cos 2 pi (across x + down y - crest)] for ON, and the same for OFF events.

    across, down: waves a pixel. crest: in turns, 0 to 1. off, on: heights [nats], below 0 where events are
    fewer on the crest.
    """

    across_per_px: float
    down_per_px: float
    crest_turns: float
    off: float
    on: float


def wave_of(step: Telling, width: int, height: int) -> PixelWave:
    """The wave that takes most from the squares of both polarities' functions, by the events in each bin."""
    x, y = _places(step.covariate.name, width, height)
    found = [_fitted(step, x, y, *each) for each in _lengths(step.covariate.name, width, height)]
    return max(found, key=lambda one: one[0])[1]


def _places(name: str, width: int, height: int) -> tuple[Array, Array]:
    """(size,) each: the pixel in the middle of each bin; 0 along what the bin does not tell of."""
    if name == "lattice":
        number = np.arange(LATTICE**2)
        return (number % LATTICE).astype(float), (number // LATTICE).astype(float)
    across, down = {"x": (LINES, 1), "y": (1, LINES), "patch": (PATCHES_ACROSS, PATCHES_DOWN)}[name]
    y, x = np.divmod(np.arange(across * down), across)
    return _middles(x, across, width), _middles(y, down, height)


def _middles(number: NDArray[np.int64], bins: int, side: int) -> Array:
    return (number + 0.5) * side / bins - 0.5 if bins > 1 else np.zeros(number.size)


def _lengths(name: str, width: int, height: int) -> Iterator[tuple[float, float]]:
    """Waves a pixel that the bins can tell: half a wave over the sensor or more, one in two bins at most."""
    if name == "lattice":
        turns = np.array([-1, 0, 1, 2]) / LATTICE
        yield from ((x, y) for x in turns[1:] for y in turns if (x, y) > (0, 0))
    elif name == "x":
        yield from ((k / (2 * width), 0.0) for k in range(1, LINES + 1) if k <= width)
    elif name == "y":
        yield from ((0.0, k / (2 * height)) for k in range(1, LINES + 1) if k <= height)
    else:
        downs = range(-PATCHES_DOWN, PATCHES_DOWN + 1)
        for across in range(PATCHES_ACROSS + 1):
            yield from ((across / (2 * width), k / (2 * height)) for k in downs if (across, k) > (0, 0))


def _fitted(step: Telling, x: Array, y: Array, across: float, down: float) -> tuple[float, PixelWave]:
    """(what it takes from the squares, the wave): a crest from both polarities, then the heights."""
    phase = 2 * np.pi * (across * x + down * y)
    events = step.share.sum(axis=1)
    off, on = (
        complex(*_least_squares([np.cos(phase), np.sin(phase)], function, share)[0])
        for function, share in zip(step.function, step.share, strict=True)
    )
    together = max((events[1] * on + sign * events[0] * off for sign in (1, -1)), key=abs)
    crest = float(np.angle(together) / (2 * np.pi)) % 1.0
    wave = np.cos(phase - 2 * np.pi * crest)
    (off_height, taken_off), (on_height, taken_on) = (
        _least_squares([wave], function, share)
        for function, share in zip(step.function, step.share, strict=True)
    )
    return taken_off + taken_on, PixelWave(across, down, crest, float(off_height[0]), float(on_height[0]))


def _least_squares(waves: Sequence[Array], function: Array, share: Array) -> tuple[Array, float]:
    """(heights of the waves beside a constant, what they take from the squares about the mean)."""
    basis = np.column_stack([np.ones(function.size), *waves])
    ridge = np.diag([1e-12, *len(waves) * [RIDGE * share.sum() + 1e-12]])
    numbers = np.linalg.solve(basis.T @ (share[:, None] * basis) + ridge, basis.T @ (share * function))
    mean = np.average(function, weights=share + 1e-12)
    taken = share @ ((function - mean) ** 2 - (function - basis @ numbers) ** 2)
    return np.asarray(numbers[1:], np.float64), float(taken)
