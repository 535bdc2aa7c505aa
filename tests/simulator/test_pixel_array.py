"""What a step of all pixels must not lose."""

import numpy as np

from voltcam_simulator import Simulator

from .scenes import intervals_us, only, watch_still


def test_a_small_leak_is_not_rounded_away_beside_a_large_response() -> None:
    """At 5000 frames/s a step gains 2e-4 of a threshold, beside a response of 26 thresholds."""
    parameters = only(contrast_response={"k1": 5.265}, junction_leak={"k4_per_us": 1e-6})
    between = intervals_us(watch_still(Simulator(30, 1, parameters, seed=1), 128, 3, 5000), 30)
    np.testing.assert_allclose(between, 1e6, rtol=1e-3)
