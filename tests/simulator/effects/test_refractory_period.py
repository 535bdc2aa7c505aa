"""The dead time: a hole in the intervals of each pixel, and rates that cannot pass 1/period."""

import numpy as np
import pytest

from voltcam_simulator import Simulator

from ..scenes import intervals_us, only, still, watch_still

SIDE = 40


@pytest.mark.parametrize("fps", [1, 30, 777])
@pytest.mark.parametrize("period_us", [500, 7000])
def test_the_hole_in_the_intervals_is_the_period_however_frames_cut_it(fps: float, period_us: float) -> None:
    """Noise of 2500 exits a second: intervals go down to the dead time, which is up to five frames long."""
    parameters = only(leak_noise={"k6": 0.05}, refractory_period={"period_us": period_us})
    between = intervals_us(watch_still(Simulator(SIDE, SIDE, parameters, seed=1), 9, 1, fps), SIDE)
    assert between.min() >= period_us
    # exits take 1/sigma^2 = 400 us on average, none less than 20 us (chance e^{-1/(2 * 0.0025 * 20)} = 5e-5)
    assert between.min() < period_us + 60
    spread_us = np.sqrt(2 / 3) * 400  # of an exit from the middle of a band
    assert between.mean() == pytest.approx(period_us + 400, abs=5 * spread_us / np.sqrt(len(between)))


@pytest.mark.parametrize("fps", [3, 250])
@pytest.mark.parametrize("rate_per_us", [1e-5, 1e-4, 2e-3])
def test_a_rate_falls_to_what_the_dead_time_leaves_of_it(fps: float, rate_per_us: float) -> None:
    """Without noise intervals are 1/r + period exactly, to the rounding of time stamps."""
    parameters = only(junction_leak={"k4_per_us": rate_per_us}, refractory_period={"period_us": 800})
    between = intervals_us(watch_still(Simulator(SIDE, SIDE, parameters, seed=2), 9, 1, fps), SIDE)
    np.testing.assert_allclose(between, 1 / rate_per_us + 800, atol=1.5)


def test_a_fast_edge_loses_events_and_a_slow_one_does_not() -> None:
    counts = {}
    for period_us in (0, 1000):
        parameters = only(contrast_response={"k1": 10}, refractory_period={"period_us": period_us})
        for span_us in (10_000, 10_000_000):
            simulator = Simulator(SIDE, SIDE, parameters, seed=3)
            simulator.advance(still(10, SIDE, SIDE), 0)
            counts[period_us, span_us] = len(simulator.advance(still(200, SIDE, SIDE), span_us)) / SIDE**2
    # 10 ln(220/30) = 19.9 thresholds, at 2 per ms or 2 per s; with 1 ms of dead time each takes 1.5 ms
    assert counts[0, 10_000] == pytest.approx(19.42, abs=0.1)
    assert counts[1000, 10_000] == pytest.approx(10 / 1.5, abs=0.6)
    assert counts[1000, 10_000_000] == pytest.approx(counts[0, 10_000_000], abs=0.1)


def test_what_happens_in_the_dead_time_is_lost() -> None:
    parameters = only(contrast_response={"k1": 1}, refractory_period={"period_us": 100_000})
    simulator = Simulator(SIDE, SIDE, parameters, seed=3)
    counts = []
    # thresholds above 100 DN: all fire once; 0.9 in the dead time; after it 0.9 and 0.2, when 1 is reached
    for t_us, v in ((0, 0), (1000, 2.5), (50_000, 3.4), (110_000, 3.4), (120_000, 4.3), (130_000, 4.5)):
        counts.append(len(simulator.advance(still(120 * np.exp(v) - 20, SIDE, SIDE), t_us)) / SIDE**2)
    assert counts == [0, 1, 0, 0, 0, 1]


def test_it_goes_on_through_a_change_of_parameters_and_can_be_switched_off() -> None:
    dead = only(junction_leak={"k4_per_us": 1e-3}, refractory_period={"period_us": 50_000})
    simulator = Simulator(SIDE, SIDE, dead, seed=4)
    simulator.advance(still(9, SIDE, SIDE), 0)
    assert len(simulator.advance(still(9, SIDE, SIDE), 2000)) == SIDE**2
    simulator.parameters = dead.changed({"refractory_period": {"period_us": 0}})
    assert len(simulator.advance(still(9, SIDE, SIDE), 40_000)) == 0  # still in the dead time they were given
    between = intervals_us(watch_still(simulator, 9, 0.1, 100, 41_000), SIDE)
    np.testing.assert_allclose(between, 1000, atol=1.5)
