"""A recording in, the parameters of its camera out, each with an interval and with what it rests on."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from voltcam_simulator import Parameters

from .estimates import NORMAL_90, Estimate, correlations, estimates_of, likelihood_parameters, noise_shares
from .fit import PRIOR, Fit, fit, maximise, named
from .reading import Reading
from .timing import find_times
from .twins import TWINS, unbiased

__all__ = ["Calibration", "CalibrationError", "Estimate", "Reading", "calibrate"]

SAMPLE = 12_000  # intervals that are fitted: more cost time and add nothing to errors of the light
STILL = 24_000  # of light that hardly moves, in addition
FEW = 3_000  # for a first look
UNSURE = 0.3  # of what twins take off: their light is not the recording's
FEWEST = 200  # intervals with an event
Report = Callable[[str], None]


class CalibrationError(ValueError):
    """A recording from which nothing can be fitted; the message is the verdict, in a line."""


@dataclass(frozen=True, eq=False)
class Calibration:
    """Parameters of the camera, and all that a report says of them. reading: what was fitted, a sample of the
    pixels, with light on the events' clock; delay_us: how late events are on it, before 0 where they come
    before their light; events: how many end an interval."""

    parameters: Parameters
    estimates: tuple[Estimate, ...]
    correlations: dict[tuple[str, str], float]
    delay_us: float
    dead_us: float
    fit: Fit
    reading: Reading
    events: int


def calibrate(
    reading: Reading, seed: int = 0, report: Report = lambda step: None, clocks_apart_us: float = 0.0
) -> Calibration:
    """The camera's parameters: likeliest under the exact first-passage law, freed of bias by twins.

    clocks_apart_us: how much later the light is than its frames say, on the clock of the events.
    Raises CalibrationError where there are too few intervals to fit.
    """
    rng = np.random.default_rng(seed)
    report("light")
    reading = replace(reading, scene=reading.scene.later(clocks_apart_us)).prepared()
    events = int(np.count_nonzero(reading.intervals(0.0, 0.0)["end"]))
    if events < FEWEST:
        raise CalibrationError(
            f"too few events to calibrate: {events} intervals between events of a pixel under light that the "
            f"frames tell of, {FEWEST} are needed: record slower motion, longer, or at a higher frame rate"
        )
    few, more = reading.sampled(rng, FEW), reading.sampled(rng, SAMPLE)
    sample = reading.sampled(rng, SAMPLE, STILL)
    report("first fit")
    start, _ = maximise(few.intervals(0.0, 0.0), 0.0, waits=few.waits())
    delay_us, dead_us = find_times(more, start, report)
    report("fit")
    seen = sample.intervals(dead_us, delay_us)
    found = fit(seen, dead_us, reading.scene.width, start, sample.waits())
    log, twin_sd = unbiased(sample, found, dead_us, delay_us, seed, report)
    untold = 1 - float(reading.scene.trusted().mean())
    sd = _spread(log, twin_sd, found, untold)
    scale = sd / np.sqrt(np.diag(found.covariance))
    noise = noise_shares(log, found.covariance * np.outer(scale, scale))
    values = named(log) | {"k3": noise.value[0], "k6": noise.value[1]}
    return Calibration(
        parameters=likelihood_parameters(values, dead_us, delay_us + clocks_apart_us),
        estimates=estimates_of(log, sd, noise),
        correlations=correlations(found.covariance, noise),
        delay_us=delay_us,
        dead_us=dead_us,
        fit=found,
        reading=sample,
        events=int(np.count_nonzero(seen["end"])),
    )


def _spread(
    log: NDArray[np.float64], twin_sd: NDArray[np.float64], found: Fit, untold: float
) -> NDArray[np.float64]:
    """(k,) standard deviations of the log parameters, such that NORMAL_90 of them make the interval.

    The larger of what twins have, few as they are, and what the recording's own likelihood and tiles have;
    and a part of the correction itself. untold: share of the light that frames do not tell of, wherever it
    may lead those who see it, all of them the same way. Twins, whose light is as smooth as that between the
    recording's frames, are not led astray by it: with a third of it untold, errors are a third larger.
    """
    quantile = float(student.ppf(0.95, TWINS[-1] - 1)) / NORMAL_90
    own = (1 + untold) * np.maximum(twin_sd * quantile, found.sd)
    spread = np.hypot(own, UNSURE * (log - found.log))
    return np.asarray(np.minimum(spread, PRIOR.sd))
