"""Simulations the tests share."""

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters, Simulator

Events = NDArray[np.void]

SILENT = {
    "contrast_response": {"k1": 0},
    "photon_noise": {"k3": 0},
    "junction_leak": {"k4_per_us": 0},
    "parasitic_photocurrent": {"k5_per_dn_us": 0},
    "leak_noise": {"k6": 0},
}
"""Changes that switch all effects of the base model off."""


def still(grey: float, width: int, height: int) -> NDArray[np.float32]:
    return np.full((height, width), grey, np.float32)


def watch_still(simulator: Simulator, grey: float, seconds: float, fps: float, t0_us: int = 0) -> Events:
    image = still(grey, simulator.width, simulator.height)
    times = t0_us + np.round(np.arange(seconds * fps + 1) * 1e6 / fps).astype(np.int64)
    return np.concatenate([simulator.advance(image, int(t)) for t in times])


def watch_at(
    parameters: Parameters, times_us: NDArray[np.int64], width: int, height: int, grey: float = 9
) -> Events:
    """The events of a sensor that looks at one grey, in frames at these times."""
    simulator = Simulator(width, height, parameters, seed=3)
    image = still(grey, width, height)
    return np.concatenate([simulator.advance(image, int(t)) for t in times_us])


def cuts(pieces: int, end_us: int = 2_000_000) -> NDArray[np.int64]:
    """Frame times, uneven but for one piece."""
    inner = np.random.default_rng(pieces).choice(np.arange(1, end_us), pieces - 1, replace=False)
    return np.concatenate([[0], np.sort(inner), [end_us]])


SIDE = 60
PIXELS = SIDE * SIDE
"""Of the sensor of `rate_hz`."""


def rate_hz(parameters: Parameters, grey: float, seconds: float = 20, seed: int = 1) -> tuple[float, float]:
    """ON and OFF events a second of a whole still sensor of SIDE x SIDE pixels."""
    simulator = Simulator(SIDE, SIDE, parameters, seed=seed)
    events = watch_still(simulator, grey, seconds, 5)
    on = int(events["p"].sum())
    return on / seconds, (len(events) - on) / seconds


def only(**changes: object) -> Parameters:
    """Parameters with nothing on but what is named."""
    return Parameters().changed(SILENT).changed(changes)


def intervals_us(events: Events, width: int) -> NDArray[np.int64]:
    """Times between events of the same pixel."""
    pixel = events["y"].astype(np.int64) * width + events["x"]
    order = np.lexsort((events["t"], pixel))
    return np.diff(events["t"][order])[np.diff(pixel[order]) == 0]
