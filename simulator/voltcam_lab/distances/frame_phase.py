"""When, from frame to frame, events come: what the camera's own frames do to them."""

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator.effect import Events

from ..light.frame_light import FrameLight
from .region import Region

PHASES = 40


def phase_shares(events: Events, region: Region, light: FrameLight) -> NDArray[np.float64]:
    """(2, PHASES): of all events, those of each polarity and fortieth of the way from frame to frame."""
    events = region.of(events)
    number = light.interval_of(events["t"])
    begin, end = light.t_us[number], light.t_us[number + 1]
    phase = np.clip((events["t"] - begin) / (end - begin) * PHASES, 0, PHASES - 1).astype(np.int64)
    counts = np.bincount(events["p"] * PHASES + phase, minlength=2 * PHASES).reshape(2, PHASES)
    shares: NDArray[np.float64] = counts / max(counts.sum(), 1)
    return shares


def phase_variation(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Total variation, 0 to 1, of the phases of each polarity, weighted as the first has them."""
    found = [
        one.sum() * 0.5 * float(np.abs(one / max(one.sum(), 1e-12) - two / max(two.sum(), 1e-12)).sum())
        for one, two in zip(a, b, strict=True)
    ]
    return float(np.sum(found) / max(a.sum(), 1e-12))
