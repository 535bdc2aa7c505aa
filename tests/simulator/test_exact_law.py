"""When pixels of a whole sensor fire, against closed forms: at any frame rate, however light is cut."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from voltcam_simulator import Law, Parameters, Simulator

from .scenes import Events, intervals_us, only, still, watch_still

P_LIMIT = 1e-4


@pytest.mark.parametrize("fps", [30, 240, 1000])
def test_leak_intervals_are_brownian_at_any_frame_rate(fps: int) -> None:
    simulator = Simulator(48, 40, Parameters.of("paper"), seed=fps)
    between = intervals_us(watch_still(simulator, 128, 8, fps), 48)
    mu = 1e-7 + 5e-9 * 128
    sigma = 1e-4 * math.sqrt(128) / 148 + 1e-5
    law = stats.invgauss(mu=sigma**2 / mu, scale=1 / sigma**2)  # mean 1/mu, shape (1/sigma)^2
    assert law.std() == pytest.approx(27_700, rel=0.01)  # the figure of the design page
    # the window of 8 s favours short intervals, here by less than .1 % of the mean
    assert stats.kstest(between, law.cdf).pvalue > P_LIMIT


@pytest.mark.parametrize(("fps", "spread_ms"), [(30, 8.7), (240, 4.1), (1000, 1.7)])
def test_the_paper_law_averages_its_noise_away(fps: int, spread_ms: float) -> None:
    simulator = Simulator(40, 30, Parameters.of("paper"), law="paper", seed=1)
    between = intervals_us(watch_still(simulator, 128, 5.6, fps), 40)
    assert between.mean() == pytest.approx(1.351e6, rel=0.005)
    assert between.std() / 1e3 == pytest.approx(spread_ms, rel=0.2)


def test_the_leak_rate_is_the_long_run_one_from_the_start() -> None:
    simulator = Simulator(200, 200, Parameters.of("paper"), seed=4)
    events = watch_still(simulator, 128, 0.5, 30)
    expected = 7.4e-7 * 0.5e6 * 200 * 200
    # a pixel fires once at most, so the count is binomial: 5 standard deviations, chance 6e-7
    assert abs(len(events) - expected) < 5 * math.sqrt(expected)
    assert events["p"].all()
    halves = np.histogram(events["t"], [0, 250_000, 500_000])[0]
    assert abs(halves[0] - halves[1]) < 5 * math.sqrt(expected)


def log_ramp(start: float, end: float, cuts: int, shape: tuple[int, int]) -> list[NDArray[np.float64]]:
    """Frames whose ln(F + k2) is a straight line in time."""
    return [
        np.full(shape, (start + 20) * ((end + 20) / (start + 20)) ** (i / cuts) - 20) for i in range(cuts + 1)
    ]


@pytest.mark.parametrize("noise_in_bands", [0.01, 0.5, 2.0])
@pytest.mark.parametrize("cuts", [8, 33])
def test_a_ramp_has_the_same_statistics_however_it_is_cut(cuts: int, noise_in_bands: float) -> None:
    """The drift is a straight line and the noise constant, so the exact law must not see the frames."""
    parameters = only(contrast_response={"k1": 2.0}, leak_noise={"k6": 2 * noise_in_bands / 1000})

    def run(pieces: int, seed: int) -> Events:
        simulator = Simulator(60, 60, parameters, seed=seed)
        frames = log_ramp(30, 220, pieces, (60, 60))
        times = [round(1e6 * i / pieces) for i in range(pieces + 1)]
        return np.concatenate([simulator.advance(f, t) for f, t in zip(frames, times, strict=True)])

    whole, cut = run(1, 1), run(cuts, 2)
    for polarity in (True, False):
        a, b = whole[whole["p"] == polarity], cut[cut["p"] == polarity]
        if len(a) + len(b) < 50:
            continue
        per_pixel = [np.bincount(e["y"].astype(int) * 60 + e["x"], minlength=3600) for e in (a, b)]
        spread = math.sqrt(sum(counts.var() / counts.size for counts in per_pixel))
        assert abs(per_pixel[0].mean() - per_pixel[1].mean()) <= 4 * spread  # 6e-5 for a correct sampler
        assert stats.ks_2samp(a["t"], b["t"]).pvalue > P_LIMIT
    gaps = [intervals_us(e, 60) for e in (whole, cut)]
    assert stats.ks_2samp(*gaps).pvalue > P_LIMIT


def test_zero_to_white_is_the_logarithm_not_its_linearisation() -> None:
    counts: dict[Law, int] = {}
    for law in ("exact", "paper"):
        parameters = only(contrast_response={"k1": 5.265, "k2_dn": 20})
        simulator = Simulator(1, 1, parameters, law=law, seed=0)
        simulator.jump(still(0, 1, 1), 0)
        simulator.advance(still(0, 1, 1), 1000)
        events = simulator.advance(still(255, 1, 1), 2000)
        assert events["p"].all()
        counts[law] = len(events)
    # 2.62 k1 = 13.8 thresholds from a start in (-1, 1); linearised 1.73 k1 = 9.1 from 0
    assert counts["exact"] in (13, 14)
    assert counts["paper"] == 9


def test_darkening_gives_off_events_and_halving_thresholds_doubles_them() -> None:
    totals = []
    for theta in (1.0, 0.5):
        thresholds = {"theta_on": theta, "theta_off": theta}
        simulator = Simulator(32, 32, only(contrast_response={"k1": 5}, comparator=thresholds), seed=7)
        simulator.advance(still(200, 32, 32), 0)
        events = simulator.advance(still(10, 32, 32), 10_000)
        assert not events["p"].any()
        totals.append(len(events) / 1024)
    # the start is a tent, its remainder modulo a threshold uniform: half an event is lost to rounding down
    change = 5 * math.log(220 / 30)
    spread = math.sqrt(1 / 6 / 1024)
    assert totals[0] == pytest.approx(change - 0.5, abs=5 * spread)
    assert totals[1] == pytest.approx(2 * change - 0.5, abs=5 * spread)


def test_ten_hours_of_sparse_frames() -> None:
    """A frame each five seconds for ten hours: each hour has as many leak events as it should."""
    simulator = Simulator(8, 8, Parameters.of("paper"), seed=11)
    events = watch_still(simulator, 128, 36_000, 0.2)
    rate = 7.4e-7
    expected = rate * 3.6e10 * 64
    # intervals spread by 2 % only, so the count is that of a renewal process: sd < sqrt(64) events
    assert len(events) == pytest.approx(expected, abs=64)
    hours = np.histogram(events["t"], np.arange(0, 11) * 3_600_000_000)[0]
    np.testing.assert_allclose(hours, expected / 10, atol=64)
    assert events["t"].max() > 35_990_000_000
