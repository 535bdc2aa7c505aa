"""How late events are, such that simulated ones are as late as the recorded, by one measure of both."""

from dataclasses import replace

import numpy as np
from scipy.stats import t as student

from voltcam_simulator import Parameters

from ..health import inspect
from ..health.lag import Lag, find_lag, threshold_of
from ..health.subject import subject_of
from ..light.scene import Scene
from ..models.model import MODELS, simulate
from ..recordings import Footage

LONGEST_US = 100_000.0  # as early as a camera's events may be
CAMERAS_US = 0.0, 12_000.0  # lags that are a camera's own: its low pass, latency and thresholds
USUAL_US = 4_000.0  # such a lag
ROUNDS = 2  # the lag does not follow the delay exactly, as events are compared with frames


def clocks_apart_us(lag: Lag) -> float:
    """By how much the frames' clock is off [us], where the lag is none that a camera has by itself; else 0.

    Frames that a computer stamps when they arrive come tens of milliseconds after their light.
    """
    first_us, last_us = CAMERAS_US
    if not lag.is_sure or first_us <= lag.lag_us <= last_us:
        return 0.0
    return float(lag.lag_us) - USUAL_US


def as_late_as(footage: Footage, scene: Scene, parameters: Parameters, seed: int) -> tuple[Parameters, str]:
    """The parameters with another `latency.delay_us`, and what was found, in words.

    footage, scene: of the same pixels and time. Simulated events are late by themselves, too: by the low pass
    of the photoreceptor and since a threshold takes time to be reached. So their lag behind the frames is
    measured as that of the recorded ones is (`health.lag`, with one threshold for both), and the delay makes
    up for the difference. A delay that was fitted within the 90 % interval stays.
    """
    inspection = inspect(footage)
    real, threshold = inspection.lag, threshold_of(inspection.subject)
    delay_us, sure_us = parameters.latency.delay_us, 0.0
    for _ in range(ROUNDS):
        moved = parameters.changed({"latency": {"delay_us": delay_us}})
        events = simulate(MODELS["exact"](footage.width, footage.height, moved, seed), scene)
        if not len(events):
            return parameters, "delay as fitted: nothing was simulated to compare it with"
        simulated = find_lag(subject_of(replace(footage, events=events)), threshold)
        delay_us, sure_us = delay_us + real.lag_us - simulated.lag_us, _sure_us(real, simulated)
    low, high = delay_us - sure_us, delay_us + sure_us
    if low <= parameters.latency.delay_us <= high:
        delay_us = parameters.latency.delay_us
    delay_us = min(max(delay_us, -LONGEST_US), LONGEST_US)
    words = (
        f"events are {real.lag_us / 1000:.1f} +- {real.uncertainty_us / 1000:.1f} ms behind the frames; "
        f"simulated ones are with a delay of {delay_us:.0f} us ({low:.0f} to {high:.0f})"
    )
    return parameters.changed({"latency": {"delay_us": round(delay_us, 1)}}), words


def _sure_us(real: Lag, simulated: Lag) -> float:
    """Half the 90 % interval of how much later one is than the other [us]. Group by group they are of the
    same light, so what light and threshold do to a lag is in both and falls out."""
    apart_us = np.subtract(real.parts_us, simulated.parts_us)
    return float(student.ppf(0.95, len(apart_us) - 1) * apart_us.std(ddof=1) / np.sqrt(len(apart_us)))
