"""How far stamps scatter: by how wide the scan is that reading a frame makes down the rows.

A row's line goes up at once for all of its pixels, so what spreads their stamps is the camera's jitter.
"""

import math

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters
from voltcam_simulator.effect import Events

from ..health.exposure_times import crowd
from ..recordings import Footage

BIN_US, NEAR_US, FAR_US = 2.0, 150.0, 400.0  # a scan is looked for within NEAR_US, what is no scan beyond
SIGMA = 0.158655  # of a normal law, below one standard deviation from its mean
FEWEST = 100  # events of a scan that tell its width


def as_scattered(
    footage: Footage, simulated: Events, parameters: Parameters
) -> tuple[Parameters, str | None]:
    """The parameters with `latency.jitter_us` such that the scan is as wide as the recorded one, and what was
    found, in words; as they are and None where there is no scan, or it is no wider than the simulated one.

    simulated: with the parameters, of the same scene; their `aps_coupling` makes the scan.
    """
    real, made = (scan_variance(one, footage, parameters) for one in (footage.events, simulated))
    if real is None or made is None:
        return parameters, None
    jitter_us = math.sqrt(max(real - made + parameters.latency.jitter_us**2, 0.0))
    if jitter_us < 1:
        return parameters, None
    words = f"events of one row's reading scatter by {math.sqrt(real):.0f} us: a jitter of {jitter_us:.0f} us"
    return parameters.changed({"latency": {"jitter_us": round(jitter_us, 1)}}), words


def scan_variance(events: Events, footage: Footage, parameters: Parameters) -> float | None:
    """Of the times of ON events about their row's turn [us^2], what comes all the time taken off; None where
    too few come in turn."""
    readout, period_us = parameters.aps_coupling, parameters.aps_coupling.frame_period_us
    if not (readout.reset_kick or readout.readout_kick):
        return None
    on = events[events["p"]]
    turn_us = on["t"] - footage.frame_t_us[0] - readout.row_us * on["y"].astype(np.float64)
    phase, _ = crowd(turn_us, period_us)
    late_us = (turn_us / period_us - phase + 0.5) % 1.0 * period_us - period_us / 2
    return _variance(late_us)


def _variance(late_us: NDArray[np.float64]) -> float | None:
    edges = np.arange(-FAR_US, FAR_US + BIN_US, BIN_US)
    counts, middles = np.histogram(late_us, edges)[0], (edges[1:] + edges[:-1]) / 2
    near = np.abs(middles) < NEAR_US
    excess = counts[near] - counts[~near].mean()
    if excess.sum() < FEWEST:
        return None
    total = np.cumsum(excess) / excess.sum()
    low, high = (float(middles[near][np.argmax(total >= share)]) for share in (SIGMA, 1 - SIGMA))
    return (high - low) ** 2 / 4  # by quantiles: few events far off, that are no scan's, must not count
