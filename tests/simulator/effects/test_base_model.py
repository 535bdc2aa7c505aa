"""The terms of the paper's model together: figures of the paper and of the design page."""

import math

import numpy as np
import pytest

from voltcam_simulator import Parameters, Simulator

from ..scenes import PIXELS, SIDE, watch_still


@pytest.mark.parametrize(("sigma_factor", "rates"), [(30, (1 / 1.338, 0.0)), (300, (14.4, 13.6))])
@pytest.mark.parametrize("fps", [30, 240])
def test_strong_noise_meets_two_barriers(sigma_factor: float, rates: tuple[float, float], fps: int) -> None:
    """The design page's figures for L = 128, DAVIS346, with sigma times 30 and 300."""
    noisy = {"photon_noise": {"k3": 1e-4 * sigma_factor}, "leak_noise": {"k6": 1e-5 * sigma_factor}}
    simulator = Simulator(SIDE, SIDE, Parameters.of("paper").changed(noisy), seed=6)
    seconds = 40 if sigma_factor == 30 else 5
    events = watch_still(simulator, 128, seconds, fps)
    on = events["p"].mean() * len(events) / PIXELS / seconds
    off = (~events["p"]).mean() * len(events) / PIXELS / seconds
    if sigma_factor == 30:
        assert on + off == pytest.approx(rates[0], rel=0.01)
    else:
        assert (on, off) == pytest.approx(rates, rel=0.01)


def test_static_ramp_has_the_paper_s_figure_6() -> None:
    """ON noise rises with intensity as mu(L), OFF is nearly zero."""
    ramp = np.tile(np.arange(256, dtype=np.uint8), (64, 1))
    simulator = Simulator(256, 64, Parameters.of("paper"), seed=8)
    events = np.concatenate([simulator.advance(ramp, t) for t in range(0, 30_000_001, 200_000)])
    on = np.bincount(events["x"][events["p"]], minlength=256) / 64 / 30
    expected = (1e-7 + 5e-9 * np.arange(256)) * 1e6
    # within one event per pixel of 30 s of a renewal process: 5 standard deviations of a uniform phase
    np.testing.assert_allclose(on, expected, atol=5 * 0.5 / math.sqrt(64) / 30)
    assert (~events["p"]).sum() < 0.001 * len(events)
