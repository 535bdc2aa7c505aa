"""Leak noise: the intervals between leak events are inverse Gaussian."""

from scipy import stats

from voltcam_simulator import Simulator

from ..scenes import SIDE, intervals_us, only, watch_still


def test_leak_noise_spreads_the_leak_intervals() -> None:
    mu, sigma = 1e-6, 1e-4
    simulator = Simulator(SIDE, SIDE, only(junction_leak={"k4_per_us": mu}, leak_noise={"k6": sigma}), seed=2)
    between = intervals_us(watch_still(simulator, 10, 60, 5), SIDE)
    law = stats.invgauss(mu=sigma**2 / mu, scale=1 / sigma**2)
    assert stats.kstest(between, law.cdf).pvalue > 1e-4
