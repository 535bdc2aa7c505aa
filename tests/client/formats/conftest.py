"""Fixtures of the recording formats' tests."""

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from voltcam_client.packet import EVENT

MakeEvents = Callable[..., npt.NDArray[np.void]]


@pytest.fixture
def make_events() -> MakeEvents:
    """make_events(count, start_us=..., seed=...): events of a 346x260 camera, about 333 us apart."""

    def make(count: int, start_us: int = 0, seed: int = 1) -> npt.NDArray[np.void]:
        rng = np.random.default_rng(seed)
        events = np.empty(count, EVENT)
        events["t"] = start_us + np.cumsum(rng.integers(0, 667, count))
        events["x"] = rng.integers(0, 346, count)
        events["y"] = rng.integers(0, 260, count)
        events["p"] = rng.integers(0, 2, count)
        return events

    return make


@pytest.fixture
def slider_depth() -> Path:
    """The folder of the Event Camera Dataset's slider_depth, which is not in the repository."""
    return _real("slider_depth")


@pytest.fixture
def street() -> Path:
    """A DAVIS346's AEDAT4 file, which is not in the repository either."""
    return _real("davis346_street/davis346.aedat4")


def _real(name: str) -> Path:
    root = Path(__file__).resolve().parents[3]
    path = Path(os.environ.get("VOLTCAM_DATA", root.parent / "shared" / "data")) / name
    if not path.exists():
        pytest.skip(f"no {name} in ../shared/data or $VOLTCAM_DATA")
    return path
