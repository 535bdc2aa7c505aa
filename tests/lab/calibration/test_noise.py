"""Noise at two brightnesses, and what it says of k3 and k6."""

import numpy as np
import pytest

from voltcam_lab.calibration.noise import LARGEST_RATIO, USUAL, Shares, ratio_of, shares, split

CENTRE, WIDE = np.log(np.array(ratio_of(*USUAL))), np.array([1.0, 0.2])


def told(bright: float, ratio: float, sd: tuple[float, float]) -> Shares:
    """From noise found to sd by data alone: the prior's part put in as a fit does it."""
    data, prior = np.diag(np.square(sd)), np.diag(WIDE**2)
    covariance = np.asarray(np.linalg.inv(np.linalg.inv(data) + np.linalg.inv(prior)), np.float64)
    found = covariance @ (np.linalg.solve(data, np.log([bright, ratio])) + np.linalg.solve(prior, CENTRE))
    return shares(found, covariance, CENTRE, WIDE)


@pytest.mark.parametrize(("k3", "k6"), [(1e-4, 1e-5), (2e-4, 0.0), (0.0, 3e-5)])
def test_two_brightnesses_are_k3_and_k6(k3: float, k6: float) -> None:
    bright, ratio = ratio_of(k3, k6)
    assert split(bright, ratio) == pytest.approx((k3, k6), abs=1e-15)
    assert bright == pytest.approx(k3 * np.sqrt(200) / 220 + k6)
    assert 1 <= ratio <= LARGEST_RATIO


def test_noise_that_is_known_well_fixes_both() -> None:
    """The prior of the fit is taken out again, and errors are those of the difference quotient."""
    bright, ratio = ratio_of(2e-4, 1.2e-5)
    found = told(bright, ratio, (0.01, 0.01))
    assert found.value == pytest.approx((2e-4, 1.2e-5), rel=0.03)
    assert found.sd[0] == pytest.approx(np.hypot(0.01, 0.01 * ratio / (ratio - 1)), rel=0.1)
    assert found.interval[0][0] < 2e-4 < found.interval[0][1]
    assert found.correlation < -0.5


def test_without_data_there_is_the_prior() -> None:
    found = shares(CENTRE, np.diag(WIDE**2), CENTRE, WIDE)
    assert found.value == pytest.approx(USUAL, rel=0.02)
    assert found.sd == pytest.approx((1.0, 1.0), rel=0.03)
    assert found.interval[1] == pytest.approx((1e-5 * np.exp(-1.645), 1e-5 * np.exp(1.645)), rel=0.05)
    assert found.correlation == pytest.approx(0, abs=0.05)


@pytest.mark.parametrize(("ratio", "gone"), [(0.9, 0), (2.0, 1)])
def test_noise_that_cannot_be_is_the_nearest_that_can(ratio: float, gone: int) -> None:
    """Where it is bright it is as strong as was found, by the other of the two alone."""
    found = told(2e-5, ratio, (0.02, 0.02))
    assert found.value[0] * np.sqrt(200) / 220 + found.value[1] == pytest.approx(2e-5, rel=0.08)
    share = np.array([found.value[0] * np.sqrt(200) / 220, found.value[1]]) / 2e-5
    assert 0 < share[gone] < 0.1
