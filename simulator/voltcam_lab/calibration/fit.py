"""The parameters under which the intervals of a recording are most likely."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .ascent import Prior, Vector, ascend, scores
from .intervals import Intervals
from .likelihood import LARGEST, START, Likelihood
from .noise import LARGEST_RATIO, ratio_of, split
from .rest import NO_WAITS, Waits


def _fitted(values: dict[str, float]) -> dict[str, float]:
    """Parameters as they are fitted: bright noise and its ratio in the places of k3 and k6."""
    noise, ratio = ratio_of(values["k3"], values["k6"])
    names = {"k3": ("noise", noise), "k6": ("noise_ratio", ratio)}
    return dict(names.get(name, (name, value)) for name, value in values.items())


_FITTED = _fitted(START)
NAMES = tuple(_FITTED)
PRIOR_SD = dict.fromkeys(NAMES, 1.0) | {
    "k4_per_us": 2.0, "k5_per_dn_us": 2.0, "on_over_off": 0.3, "noise_ratio": 0.2,
    "light_wander": 1.5, "reset_spread": 1.5,
}  # fmt: skip
"""Of the logarithm of each parameter about its START: a factor 2.7 either way; leaks 7, reset noise 4.5,
thresholds 1.35, noise in dim light 1.2 (more than k3 and k6 could do)."""
EM_STEPS = 10
TILE = 8  # pixels a side: neighbours see the same edges, so they do not count as independent

_START = np.log(np.array(list(_FITTED.values())))
_WIDE = np.log(np.array(list((_FITTED | {"reset_spread": 0.3}).values())))
_MIDDLE = 0.5 * np.log(LARGEST_RATIO)  # of what the ratio of noise may be, ...
_HALF = _MIDDLE + 0.3  # ... and beyond which it goes by no more than errors do
_RATIO = NAMES.index("noise_ratio")
_HIGHEST = np.log([LARGEST.get(name, 1e9) for name in NAMES])
PRIOR = Prior(_START, np.array(list(PRIOR_SD.values())))


@dataclass(frozen=True, eq=False)
class Fit:
    """log: (k,) logarithms of the parameters in the order of NAMES; covariance: (k, k) of these, by the
    sandwich over tiles of pixels; sd: (k,) the larger of its own and that by the likelihood's curvature.
    informed: (k, k), 1 in the directions that the data fix and 0 in those that the prior does (the averaging
    kernel; Rodgers 2000). own: share of the events that are the model's; stray_hz: (ON, OFF) of the others, a
    pixel."""

    log: Vector
    covariance: NDArray[np.float64]
    sd: Vector
    informed: NDArray[np.float64]
    own: float
    stray_hz: tuple[float, float]
    log_likelihood: float

    @property
    def values(self) -> dict[str, float]:
        """The parameters by name."""
        return named(self.log)


def named(log: Vector) -> dict[str, float]:
    """Parameters of the likelihood from logarithms (k,) of NAMES, none above its LARGEST; k3 or k6 is a bit
    negative where the noise's ratio is not possible."""
    log = np.minimum(log, _HIGHEST)
    log[_RATIO] = _MIDDLE + _HALF * np.tanh((log[_RATIO] - _MIDDLE) / _HALF)
    values = dict(zip(NAMES, np.exp(log).tolist(), strict=True))
    values["k3"], values["k6"] = split(values["noise"], values["noise_ratio"])
    return values


def tiles(pixel: NDArray[np.int32], width: int) -> NDArray[np.int64]:
    """Numbers (n,) of the tiles that pixels (n,) of a sensor `width` pixels wide lie in."""
    row, column = np.divmod(pixel.astype(np.int64), width)
    return np.asarray(row // TILE * (width // TILE + 1) + column // TILE)


def possible(log: Vector) -> Vector:
    """The nearest logarithms with neither k3 nor k6 negative."""
    nearest = log.copy()
    nearest[_RATIO] = np.clip(log[_RATIO], 0.0, np.log(LARGEST_RATIO))
    return nearest


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
    _, member = np.unique(tiles(likelihood.part_pixel, width), return_inverse=True)
    by_tile = np.stack([np.bincount(member, row) for row in score])
    inverse = np.linalg.inv(score @ score.T + np.diag(PRIOR.sd**-2.0))
    spread = by_tile @ by_tile.T + np.diag(PRIOR.sd**-2.0)
    covariance = inverse @ spread @ inverse
    return Fit(
        log=x,
        covariance=covariance,
        sd=np.sqrt(np.maximum(np.diag(covariance), np.diag(inverse))),
        informed=np.eye(len(x)) - inverse / PRIOR.sd**2,
        own=float(likelihood.weights.mean()) if likelihood.events else 0.0,
        stray_hz=(float(likelihood.stray_per_us[0] * 1e6), float(likelihood.stray_per_us[1] * 1e6)),
        log_likelihood=float(parts(x).sum()),
    )
