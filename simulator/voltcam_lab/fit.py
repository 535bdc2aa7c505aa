"""The parameters under which the intervals of a recording are most likely."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .ascent import Prior, Vector, ascend, scores
from .intervals import Intervals
from .likelihood import LARGEST, NAMES, START, Likelihood
from .rest import NO_WAITS, Waits

PRIOR_SD = dict.fromkeys(NAMES, 1.0) | {"k4_per_us": 2.0, "k5_per_dn_us": 2.0, "on_over_off": 0.3}
"""Of the logarithm of each parameter about its START: a factor 2.7 either way; leaks 7, thresholds 1.35."""
EM_STEPS = 10
TILE = 8  # pixels a side: neighbours see the same edges, so they do not count as independent

_START = np.log(np.array(list(START.values())))
_WIDE = np.log(np.array(list((START | {"reset_spread": 0.3}).values())))
_HIGHEST = np.log([LARGEST.get(name, 1e9) for name in NAMES])
PRIOR = Prior(_START, np.array(list(PRIOR_SD.values())))


@dataclass(frozen=True, eq=False)
class Fit:
    """log: (k,) logarithms of the parameters in the order of NAMES; covariance: (k, k) of these, by the
    sandwich over tiles of pixels; sd: (k,) the larger of its own and that by the likelihood's curvature. own:
    share of the events that are the model's; stray_hz: (ON, OFF) of the others, a pixel."""

    log: Vector
    covariance: NDArray[np.float64]
    sd: Vector
    own: float
    stray_hz: tuple[float, float]
    log_likelihood: float

    @property
    def values(self) -> dict[str, float]:
        """The parameters by name."""
        return named(self.log)


def named(log: Vector) -> dict[str, float]:
    """Parameters by name from their logarithms, none above its LARGEST."""
    return dict(zip(NAMES, np.exp(np.minimum(log, _HIGHEST)).tolist(), strict=True))


def maximise(
    seen: Intervals,
    dead_us: float,
    start: Vector | None = None,
    em_steps: int = EM_STEPS,
    steps: int = 25,
    waits: Waits = NO_WAITS,
) -> tuple[Vector, Likelihood]:
    """The log parameters of highest posterior, and the likelihood with its weights there.

    Without a start the search begins with wide errors, which let it see a far way.
    """
    likelihood = Likelihood(seen, dead_us, waits)
    likelihood.stray_per_us[:] = 0.01 * likelihood.events / likelihood.span_us
    x = _WIDE.copy() if start is None else start
    if start is not None:
        likelihood.reweigh(named(x))
    for _ in range(em_steps):
        former = x
        x = ascend(lambda x: likelihood.parts(named(x)), x, PRIOR, steps, counts=likelihood.counts)
        likelihood.reweigh(named(x))
        if np.abs(x - former).max() < 0.003:
            break
    return x, likelihood


def fit(
    seen: Intervals, dead_us: float, width: int, start: Vector | None = None, waits: Waits = NO_WAITS
) -> Fit:
    """Fit intervals of a sensor `width` pixels wide whose pixels are held for dead_us after an event."""
    x, likelihood = maximise(seen, dead_us, start, waits=waits)

    def parts(x: Vector) -> Vector:
        return likelihood.parts(named(x))

    score = scores(parts, x) / np.sqrt(likelihood.counts)
    pixel = likelihood.part_pixel.astype(np.int64)
    tile = (pixel // width // TILE) * (width // TILE + 1) + pixel % width // TILE
    _, member = np.unique(tile, return_inverse=True)
    by_tile = np.stack([np.bincount(member, row) for row in score])
    inverse = np.linalg.inv(score @ score.T + np.diag(PRIOR.sd**-2.0))
    spread = by_tile @ by_tile.T + np.diag(PRIOR.sd**-2.0)
    covariance = inverse @ spread @ inverse
    return Fit(
        log=x,
        covariance=covariance,
        sd=np.sqrt(np.maximum(np.diag(covariance), np.diag(inverse))),
        own=float(likelihood.weights.mean()) if likelihood.events else 0.0,
        stray_hz=(float(likelihood.stray_per_us[0] * 1e6), float(likelihood.stray_per_us[1] * 1e6)),
        log_likelihood=float(parts(x).sum()),
    )
