"""How late events are, such that simulated ones are as late as the recorded, by one measure of both."""

from dataclasses import replace

from voltcam_simulator import Parameters

from ..health import inspect
from ..health.lag import Lag, find_lag
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
    measured as that of the recorded ones is (`health.lag`), and the delay makes up for the difference.
    A delay that was fitted within the 90 % interval stays.
    """
    real = inspect(footage).lag
    sure_us = 1.645 * real.uncertainty_us
    delay_us = parameters.latency.delay_us
    for _ in range(ROUNDS):
        moved = parameters.changed({"latency": {"delay_us": delay_us}})
        events = simulate(MODELS["exact"](footage.width, footage.height, moved, seed), scene)
        if not len(events):
            return parameters, "delay as fitted: nothing was simulated to compare it with"
        lag_us = find_lag(inspect(replace(footage, events=events)).subject).lag_us
        delay_us += real.lag_us - lag_us
    low, high = delay_us - sure_us, delay_us + sure_us
    if low <= parameters.latency.delay_us <= high:
        delay_us = parameters.latency.delay_us
    delay_us = min(max(delay_us, -LONGEST_US), LONGEST_US)
    words = (
        f"events are {real.lag_us / 1000:.1f} +- {real.uncertainty_us / 1000:.1f} ms behind the frames; "
        f"simulated ones are with a delay of {delay_us:.0f} us ({low:.0f} to {high:.0f})"
    )
    return parameters.changed({"latency": {"delay_us": round(delay_us, 1)}}), words
