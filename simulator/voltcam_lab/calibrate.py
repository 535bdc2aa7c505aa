"""A recording in, the parameters of its camera out, each with an interval and with what it rests on."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from voltcam_simulator import Camera, Parameters

from .fit import PRIOR_SD, Fit, fit, maximise, named
from .intervals import Intervals, intervals
from .likelihood import NAMES
from .scene import Scene, scene_of
from .twins import twin

SAMPLE = 12_000  # intervals that are fitted: more cost time and add nothing to errors of the light
FEW = 3_000  # the same, where only the best of several readings is looked for
TWINS = 8
WELL_SAMPLED = 0.9  # share of the light that is trusted from which nothing better is looked for
LEAST_SPREAD = 1e-4  # thresholds: nothing
DELAYS_US = np.arange(-4000.0, 12_001.0, 1000.0)
DEAD_US = np.concatenate([[0.0], 50 * 1.4 ** np.arange(18)])
Report = Callable[[str], None]

PLACES = {
    "k1": ("contrast_response", "k1"),
    "k2_dn": ("contrast_response", "k2_dn"),
    "k3": ("photon_noise", "k3"),
    "k4_per_us": ("junction_leak", "k4_per_us"),
    "k5_per_dn_us": ("parasitic_photocurrent", "k5_per_dn_us"),
    "k6": ("leak_noise", "k6"),
    "threshold_spread": ("threshold_mismatch", "sigma"),
    "leak_spread": ("leak_mismatch", "sigma"),
    "reset_spread": ("reset_noise", "sigma"),
}
"""Where the parameters of the likelihood are in a camera file; the ratio of the thresholds aside."""


@dataclass(frozen=True)
class Estimate:
    """A parameter: value, 90 % interval, and the share of what is known of it that the recording gave."""

    effect: str
    parameter: str
    value: float
    low: float
    high: float
    informed: float

    @property
    def determined(self) -> bool:
        """Whether the recording fixes it, rather than what is usual."""
        return self.informed > 0.5


@dataclass(frozen=True, eq=False)
class Calibration:
    """Parameters of the camera, and all that a report says of them."""

    parameters: Parameters
    estimates: tuple[Estimate, ...]
    delay_us: float
    dead_us: float
    fit: Fit
    scene: Scene
    keep: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Reading:
    """What of a recording is fitted: events, light, pixels (H, W), and times (M, 2) [us] to leave out."""

    events: NDArray[np.void]
    scene: Scene
    keep: NDArray[np.bool_]
    masked: NDArray[np.int64]

    def intervals(self, dead_us: float, delay_us: float) -> Intervals:
        """Its same-pixel intervals."""
        return intervals(self.events, self.scene, self.keep, self.masked, dead_us, delay_us)


def parameters_of(values: dict[str, float], dead_us: float, delay_us: float) -> Parameters:
    """A camera's parameters from those of the likelihood (NAMES). Mismatch too small to matter is left out."""
    changes: dict[str, dict[str, float]] = {}
    for name, (effect, parameter) in PLACES.items():
        changes.setdefault(effect, {})[parameter] = values[name]
    ratio = float(np.sqrt(values["on_over_off"]))
    changes["comparator"] = {"theta_on": ratio, "theta_off": 1 / ratio}
    changes["refractory_period"] = {"period_us": dead_us}
    changes["latency"] = {"delay_us": max(delay_us, 0.0)}
    return Parameters().changed(changes)


def calibrate(reading: Reading, seed: int = 0, report: Report = lambda step: None) -> Calibration:
    """The camera's parameters: likeliest under the exact first-passage law, freed of bias by twins.

    The error of a likelihood that is not exact, and of light that frames do not fix, is what the same fit makes
    of twins whose truth is known; it is taken off, and its spread is the interval.
    """
    report("sampling pixels")
    rng = np.random.default_rng(seed)
    few, sample = (replace(reading, keep=sampled(reading, rng, size)) for size in (FEW, SAMPLE))
    report("first fit")
    start, _ = maximise(few.intervals(0.0, 0.0), 0.0)
    report("delay")
    delay_us = _delay(few, start)
    report("dead time")
    dead_us = _dead(few, start, delay_us)
    report("fit")
    found = fit(sample.intervals(dead_us, delay_us), dead_us, reading.scene.width, start)
    log, sd = _freed_of_bias(sample, found, dead_us, delay_us, seed, report)
    parameters = parameters_of(named(log), dead_us, delay_us)
    return Calibration(
        parameters, _estimates(log, sd, found), delay_us, dead_us, found, reading.scene, sample.keep
    )


def sampled(reading: Reading, rng: np.random.Generator, size: int) -> NDArray[np.bool_]:
    """Pixels with about `size` events, alike many where the light hardly moves, moves, and moves much."""
    scene = reading.scene
    count = np.bincount(
        reading.events["y"].astype(np.int64) * scene.width + reading.events["x"],
        minlength=scene.width * scene.height,
    )
    moved = scene.images.std(axis=0).ravel()
    usable = np.flatnonzero(reading.keep.ravel() & (count > 1))
    keep = np.zeros(count.size, np.bool_)
    for part in np.array_split(usable[np.argsort(moved[usable], kind="stable")], 3):
        drawn = rng.permutation(part)
        keep[drawn[np.cumsum(count[drawn]) <= size / 3]] = True
    return keep.reshape(reading.keep.shape)


def _delay(sample: Reading, start: NDArray[np.float64]) -> float:
    """How late events are [us]; 0 where that explains them hardly worse."""

    def score(delay_us: float) -> tuple[float, int]:
        return _mixture(sample.intervals(0.0, delay_us), 0.0, start)

    return _search(score, DELAYS_US)


def _dead(sample: Reading, start: NDArray[np.float64], delay_us: float) -> float:
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
    """Where `score` is highest, by the grid and four halvings about its best; 0 where that is hardly better."""
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


def _freed_of_bias(
    sample: Reading, found: Fit, dead_us: float, delay_us: float, seed: int, report: Report
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(log parameters, their sd), by twins at the fit and again where that leads."""
    truth, sd = found.log, np.zeros(len(found.log))
    for turn in range(2):
        fits = []
        for n in range(TWINS):
            report(f"twin {turn * TWINS + n + 1} of {2 * TWINS}")
            values = named(truth)
            events = twin(
                sample.scene,
                parameters_of(values, dead_us, delay_us),
                seed + 1000 * turn + n + 1,
                values["bend_error"],
            )
            seen = replace(sample, events=events).intervals(dead_us, delay_us)
            fits.append(maximise(seen, dead_us, truth, em_steps=2)[0])
        truth = _corrected(truth, found.log, np.array(fits))
        sd = np.std(fits, axis=0, ddof=1) * np.sqrt(1 + 1 / TWINS)
    return truth, sd


def _corrected(
    truth: NDArray[np.float64], found: NDArray[np.float64], fits: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Log parameters whose twins fit as the recording did, from twins of `truth` that fit as `fits`.

    Spreads add up in squares: one that is all error of the fit goes to nothing.
    """
    shift = np.clip(fits.mean(axis=0) - found, -1, 1)
    corrected = truth - shift
    for i, name in enumerate(NAMES):
        if name.endswith("_spread"):
            square = np.exp(2 * truth[i]) - np.exp(2 * fits[:, i]).mean() + np.exp(2 * found[i])
            corrected[i] = 0.5 * np.log(max(square, LEAST_SPREAD**2))
    return corrected


def _estimates(log: NDArray[np.float64], twin_sd: NDArray[np.float64], found: Fit) -> tuple[Estimate, ...]:
    sandwich_sd = np.sqrt(np.diag(found.covariance))
    prior_sd = np.array([PRIOR_SD[name] for name in NAMES])
    sd = np.minimum(np.maximum(twin_sd * student.ppf(0.95, TWINS - 1) / 1.645, sandwich_sd), prior_sd)
    informed = np.clip(1 - sd / prior_sd, 0, 1)
    estimates = []
    for i, name in enumerate(NAMES):
        if name not in PLACES and name != "on_over_off":
            continue
        value, low, high = np.exp(log[i] + np.array([0, -1.645, 1.645]) * sd[i])
        if name == "on_over_off":
            for parameter, power in (("theta_on", 0.5), ("theta_off", -0.5)):
                ends = sorted((low**power, high**power))
                estimates.append(Estimate("comparator", parameter, value**power, *ends, informed[i]))
            continue
        estimates.append(Estimate(*PLACES[name], float(value), float(low), float(high), float(informed[i])))
    return tuple(estimates)


def scene_between(frames: NDArray[np.uint8], frame_t_us: NDArray[np.int64]) -> Scene:
    """The frames with the light between them that tells left-out frames better: a cubic, or motion."""
    cubic = scene_of(frames, frame_t_us, "cubic")
    if cubic.trusted.mean() > WELL_SAMPLED:
        return cubic
    moved = scene_of(frames, frame_t_us, "auto")
    return moved if moved.trusted.mean() > cubic.trusted.mean() else cubic
