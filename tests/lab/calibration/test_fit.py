"""The fit of intervals drawn from the closed form."""

import numpy as np
import pytest

from voltcam_lab.calibration.estimates import noise_shares
from voltcam_lab.calibration.fit import NAMES, fit
from voltcam_lab.calibration.intervals import INTERVAL
from voltcam_lab.calibration.rest import NO_WAITS, WAIT

TRUTH = {"k3": 1.5e-4, "k4_per_us": 2e-7, "k5_per_dn_us": 6e-9, "k6": 2e-5}


def drawn(pixels: int, each: int, seed: int) -> np.ndarray:
    """Intervals at rest, of pixels from dark to bright, by the inverse Gaussian law."""
    rng = np.random.default_rng(seed)
    light = np.repeat(rng.uniform(10, 230, pixels), each)
    leak = TRUTH["k4_per_us"] + TRUTH["k5_per_dn_us"] * light
    sigma = TRUTH["k3"] * np.sqrt(light) / (light + 20) + TRUTH["k6"]
    seen = np.zeros(light.size, INTERVAL)
    seen["pixel"] = np.repeat(np.arange(pixels), each)
    seen["end_us"] = rng.wald(1 / leak, 1 / sigma**2)
    seen["end"] = seen["start"] = 1
    for name in ("before", "after", "mean", "lowest", "highest"):
        seen[name] = light
    return seen


def test_leak_is_found_within_its_error() -> None:
    """Four standard deviations, twice: 1.3e-4 to fail by chance."""
    found = fit(drawn(600, 4, seed=1), 0.0, width=40)
    for name in ("k4_per_us", "k5_per_dn_us"):
        i = NAMES.index(name)
        assert abs(found.log[i] - np.log(TRUTH[name])) < 4 * found.sd[i], name
        assert found.sd[i] < 0.2
    assert found.own > 0.97


def test_noise_is_found_as_far_as_it_shows() -> None:
    """sigma at 100 DN, where k3 and k6 are not told apart, to 20 %: spreads take some of it."""
    found = fit(drawn(600, 4, seed=2), 0.0, width=40)
    sigma = found.values["k3"] * 10 / (100 + found.values["k2_dn"]) + found.values["k6"]
    assert sigma == pytest.approx(TRUTH["k3"] * 10 / 120 + TRUTH["k6"], rel=0.2)
    noise = noise_shares(found.log, found.covariance)
    assert noise.correlation < -0.5
    assert noise.interval[0][0] < TRUTH["k3"] < noise.interval[0][1]


def test_what_light_adds_while_it_moves_is_no_noise() -> None:
    """Half of the intervals are of light that moves and wanders ten times as much: sigma to 25 %, in units of
    the threshold, whose own is not told by ON alone."""
    still, moving = drawn(300, 4, seed=4), drawn(300, 4, seed=5)
    leak = TRUTH["k4_per_us"] + TRUTH["k5_per_dn_us"] * moving["mean"].astype(float)
    rng = np.random.default_rng(6)
    moving["end_us"] = rng.wald(1 / leak, 1 / np.full(len(moving), 4e-4**2))
    moving["lowest"] -= 2
    moving["highest"] += 2
    moving["pixel"] += 300
    found = fit(np.concatenate([still, moving]), 0.0, width=40).values
    unit = found["on_over_off"] ** 0.5
    sigma = found["k3"] * 10 / (100 + found["k2_dn"]) + found["k6"]
    assert sigma / unit == pytest.approx(TRUTH["k3"] * 10 / 120 + TRUTH["k6"], rel=0.25)
    assert found["light_wander"] / unit == pytest.approx(4e-4, rel=0.25)


def test_silence_alone_bounds_the_leak() -> None:
    silent = np.zeros(500, WAIT)
    silent["pixel"], silent["level"], silent["wait_us"], silent["count"] = np.arange(500), 100, 2e6, 20
    none = drawn(5, 2, seed=3)[:0]
    loud, quiet = (fit(none, 0.0, 40, waits=waits).values for waits in (NO_WAITS, silent))
    leak = quiet["k4_per_us"] + 100 * quiet["k5_per_dn_us"]
    assert leak * 2e6 * 10_000 < 20  # events that would be expected where none is
    assert leak < 0.01 * (loud["k4_per_us"] + 100 * loud["k5_per_dn_us"])
