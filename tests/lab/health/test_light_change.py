"""Where the light of frames changed, and how noisy they are."""

import numpy as np
import pytest

from voltcam_lab.health.light_change import light_change_of

PERIOD_US, FRAMES, STEP_AT = 25_000, 80, 40


def frames() -> np.ndarray:
    """Grey 100 with noise of 1.5 DN; from frame 40 on the right half is at 160."""
    noisy = np.random.default_rng(1).normal(100, 1.5, (FRAMES, 12, 16))
    noisy[STEP_AT:, :, 8:] += 60
    return np.rint(noisy).astype(np.uint8)


def test_a_step_is_seen_once_and_noise_is_none() -> None:
    light = light_change_of(frames(), np.arange(FRAMES) * PERIOD_US)
    assert light.noise_dn == pytest.approx(1.5, rel=0.2)
    assert (np.delete(light.step, STEP_AT - 1, axis=0) == 0).mean() > 0.999
    assert (light.step[STEP_AT - 1, :, :8] == 0).all()
    np.testing.assert_allclose(light.step[STEP_AT - 1, :, 8:], np.log(180 / 120), atol=0.1)
    assert light.change[:, 8:].mean() == pytest.approx(np.log(180 / 120), rel=0.05)


def test_pixels_rest_away_from_a_step_in_time_and_space() -> None:
    """Half a second before and after it, and beside it."""
    rest = light_change_of(frames(), np.arange(FRAMES) * PERIOD_US).at_rest
    near = slice(STEP_AT - 20, STEP_AT + 19)
    assert not rest[near, :, 7:].any()
    assert rest[:, :, :7].mean() > 0.9
    assert rest[: STEP_AT - 25].mean() > 0.9
