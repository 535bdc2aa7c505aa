"""The base fit from a camera file that is far off."""

import numpy as np
import pytest

from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.state import Search
from voltcam_lab.diagnosis.search.step import base_fitted
from voltcam_simulator import Parameters

from ..made_rig import CATALOGUE, PATTERNS, START, MadeRig, logs


def curved(parameters: Parameters) -> np.ndarray:
    """On the way to ten times k5, less of k6 makes up for what k5 does there; of little k6 nothing shows."""
    k5, k6 = logs(parameters)[4:]
    seen = 10 * k5 * PATTERNS[4] + 10 * (1.15 - abs(k5 - 1.15)) * PATTERNS[5]
    return 100 + seen + 10 * max(k6, -0.3) * PATTERNS[5]


def test_from_another_cameras_file_what_shows_little_starts_over() -> None:
    rig, truth = MadeRig(curved), (0, 0, 0, 0, 2.3, 0.0)
    data = curved(Hypothesis(START, shift=truth).parameters()) + rig.noise(4711)
    found = base_fitted(Search(rig, data, CATALOGUE), Hypothesis(START))
    assert found.shift[4:] == pytest.approx(truth[4:], abs=0.02)
