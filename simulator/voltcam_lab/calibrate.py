"""A recording in, the parameters of its camera out, each with an interval and with what it rests on."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from voltcam_simulator import Parameters

from .estimates import NORMAL_90, Estimate, correlations, estimates_of, parameters_of
from .fit import PRIOR_SD, Fit, fit, maximise, named
from .likelihood import NAMES
from .reading import Reading, scene_between
from .timing import find_dead_time, find_delay
from .twins import TWINS, unbiased

__all__ = ["Calibration", "CalibrationError", "Estimate", "Reading", "calibrate", "scene_between"]

SAMPLE = 12_000  # intervals that are fitted: more cost time and add nothing to errors of the light
FEW = 3_000  # the same, where only the best of several readings is looked for
SYSTEMATIC = {"k1": 0.001, "k2_dn": 0.001, "k3": 0.35, "k4_per_us": 0.001, "k5_per_dn_us": 0.001}
"""sd of logarithms that neither twins nor the likelihood show: what cameras that are known were off beyond
these (docs/calibration.md). That of k3 is large: along its ridge with k6 the two are far from normal."""
FEWEST = 200  # intervals with an event
Report = Callable[[str], None]


class CalibrationError(ValueError):
    """A recording from which nothing can be fitted; the message is the verdict, in a line."""


@dataclass(frozen=True, eq=False)
class Calibration:
    """Parameters of the camera, and all that a report says of them. delay_us: how late events are, before 0
    where they come before the frames' times. reading: what was fitted, a sample of the pixels; events: how
    many of theirs end an interval."""

    parameters: Parameters
    estimates: tuple[Estimate, ...]
    correlations: dict[tuple[str, str], float]
    delay_us: float
    dead_us: float
    fit: Fit
    reading: Reading
    events: int


def calibrate(reading: Reading, seed: int = 0, report: Report = lambda step: None) -> Calibration:
    """The camera's parameters: likeliest under the exact first-passage law, freed of bias by twins.

    Raises CalibrationError where there are too few intervals to fit.
    """
    rng = np.random.default_rng(seed)
    report("light")
    reading = reading.prepared()
    events = int(np.count_nonzero(reading.intervals(0.0, 0.0)["end"]))
    if events < FEWEST:
        raise CalibrationError(
            f"too few events to calibrate: {events} intervals between events of a pixel under light that the "
            f"frames tell of, {FEWEST} are needed: record slower motion, longer, or at a higher frame rate"
        )
    few, sample = reading.sampled(rng, FEW), reading.sampled(rng, SAMPLE)
    report("first fit")
    start, _ = maximise(few.intervals(0.0, 0.0), 0.0, waits=few.waits())
    report("delay")
    delay_us = find_delay(few, start)
    report("dead time")
    dead_us = find_dead_time(few, start, delay_us)
    report("fit")
    seen = sample.intervals(dead_us, delay_us)
    found = fit(seen, dead_us, reading.scene.width, start, sample.waits())
    log, twin_sd = unbiased(sample, found, dead_us, delay_us, seed, report)
    return Calibration(
        parameters=parameters_of(named(log), dead_us, delay_us),
        estimates=estimates_of(log, _spread(twin_sd, found)),
        correlations=correlations(found.covariance),
        delay_us=delay_us,
        dead_us=dead_us,
        fit=found,
        reading=sample,
        events=int(np.count_nonzero(seen["end"])),
    )


def _spread(twin_sd: NDArray[np.float64], found: Fit) -> NDArray[np.float64]:
    """(k,) standard deviations of the log parameters, such that NORMAL_90 of them make the interval.

    The larger of what twins have, few as they are, and what the recording's own likelihood and tiles have;
    and what neither shows of the light: SYSTEMATIC.
    """
    quantile = float(student.ppf(0.95, TWINS[-1] - 1)) / NORMAL_90
    prior_sd = np.array([PRIOR_SD[name] for name in NAMES])
    floor = np.array([SYSTEMATIC.get(name, 0.0) for name in NAMES])
    return np.asarray(np.minimum(np.hypot(np.maximum(twin_sd * quantile, found.sd), floor), prior_sd))
