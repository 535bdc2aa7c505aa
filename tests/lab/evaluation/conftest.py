"""A recording whose truth is known."""

import numpy as np
import pytest

from voltcam_lab.health import Inspection, inspect
from voltcam_lab.light.scene import scene_of
from voltcam_lab.models.model import MODELS, simulate
from voltcam_lab.recordings import Footage
from voltcam_simulator import Parameters

WIDTH, HEIGHT, FRAMES, PERIOD_US = 144, 96, 81, 20_000


TRUTH = Parameters.of("paper").changed({"comparator": {"theta_on": 1.3, "theta_off": 0.8}})


@pytest.fixture(scope="session")
def recording() -> Footage:
    """Waves that move on the left, while the right third is held; 50 fps, 1.6 s."""
    y, x = np.indices((HEIGHT, WIDTH), dtype=np.float64)
    times = np.arange(FRAMES) * PERIOD_US
    moving = x < 2 * WIDTH / 3
    frames = np.stack([
        np.where(moving, 90 + 70 * np.sin((x + y / 2 - 25e-6 * t) / 5), 60 + x / 3) for t in times
    ]).astype(np.uint8)  # fmt: skip
    t_us = times.astype(np.int64)
    events = simulate(MODELS["exact"](WIDTH, HEIGHT, TRUTH, 11), scene_of(frames, t_us, "cubic"))
    return Footage(events, WIDTH, HEIGHT, frames, t_us)


@pytest.fixture(scope="session")
def inspection(recording: Footage) -> Inspection:
    return inspect(recording)
