"""Bandwidth: after a sudden change of light the events come as the low pass lets them, later in the dark."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from voltcam_simulator import Simulator

from ..scenes import only, still

SIDE, K1, T0_US = 20, 300.0, 10**15
Floats = NDArray[np.float64]


def after_a_step(times_us: Floats, first: float, last: float, **bandwidth: float) -> Floats:
    """Net events for each pixel up to each time after a sudden change of light."""
    parameters = only(contrast_response={"k1": K1}, photoreceptor_bandwidth=bandwidth)
    simulator = Simulator(SIDE, SIDE, parameters, seed=1)
    for t_us in (0, 3000):
        assert len(simulator.advance(still(first, SIDE, SIDE), T0_US + t_us)) == 0
    totals, found = [], 0
    simulator.advance(still(last, SIDE, SIDE), T0_US + 3001)
    for t_us in times_us:
        events = simulator.advance(still(last, SIDE, SIDE), T0_US + 3001 + int(t_us))
        found += 2 * int(events["p"].sum()) - len(events)
        totals.append(found / SIDE**2)
    return np.array(totals)


def tau_us(cutoff_hz: float, grey: float) -> float:
    return 1e6 / (2 * math.pi * cutoff_hz) * 275 / (grey + 20)


@pytest.mark.parametrize(("first", "last"), [(100, 255), (0, 5), (5, 0), (200, 20), (100, 2000)])
@pytest.mark.parametrize("cutoff_hz", [30, 300])
def test_the_answer_to_a_step_is_exponential_and_slower_in_the_dark(
    first: float, last: float, cutoff_hz: float
) -> None:
    tau = tau_us(cutoff_hz, last)
    change = K1 * math.log((last + 20) / (first + 20))
    # from a thousandth to twenty time constants in a step, at the ends of which it is exact
    times = np.unique(np.round(np.cumsum([0.001, 0.002, 0.01, 0.1, 0.3, 0.6, 1, 1, 2, 5, 20]) * tau)) + 10
    counts = after_a_step(times, first, last, cutoff_hz=cutoff_hz)
    expected = change * (1 - np.exp(-times / tau))
    started = abs(expected) > 3
    # half an event is lost to rounding down; the change took 1 us
    lost = math.copysign(0.5, change)
    np.testing.assert_allclose(counts[started] + lost, expected[started], atol=0.2 + abs(change) / tau)


def test_a_ramp_is_followed_one_time_constant_late() -> None:
    """Signature by lag: 30 Hz at white is 5.3 ms there and 36 ms at 20 DN, whatever the frame rate."""
    for grey in (235.0, 20.0):
        lag_us = tau_us(30, grey)
        for frame_us in (1000, 4000):
            rate = 1e-7  # e-folds per us: 1 % of contrast in 0.1 s, so that tau stays what it is
            fine = {"theta_on": 0.1, "theta_off": 0.1}
            parameters = only(
                contrast_response={"k1": 1000}, comparator=fine, photoreceptor_bandwidth={"cutoff_hz": 30}
            )
            simulator = Simulator(8, 8, parameters, seed=2)
            times = np.arange(0, 12 * lag_us, frame_us)
            frames = [(grey + 20) * math.exp(rate * t) - 20 for t in times]
            found = [
                len(simulator.advance(still(f, 8, 8), int(t))) for f, t in zip(frames, times, strict=True)
            ]
            late_us = times[-1] - (sum(found) / 64 + 0.5) / 1e4 / rate
            assert late_us == pytest.approx(lag_us, rel=0.06)


def events_of(light: Floats, first_us: int, last_us: int, **bandwidth: float) -> NDArray[np.int64]:
    """Times of a pixel's events, light being its grey levels in equal steps from first_us to last_us, and
    the first of them for long before. Thresholds are fine: a thousandth of an e-fold is ten events."""
    parameters = only(
        contrast_response={"k1": 1000}, comparator={"theta_on": 0.1, "theta_off": 0.1},
        photoreceptor_bandwidth=bandwidth,
    )  # fmt: skip
    simulator = Simulator(1, 1, parameters, seed=1)
    for t_us in (0, first_us):
        simulator.advance(still(light[0], 1, 1), t_us)
    times = np.round(np.linspace(first_us, last_us, len(light))).astype(int)[1:]
    return np.concatenate(
        [simulator.advance(still(grey, 1, 1), int(t_us)) for grey, t_us in zip(light[1:], times, strict=True)]
    )["t"]


@pytest.mark.parametrize("span_us", [4_000, 33_000])
@pytest.mark.parametrize(
    ("first", "last", "off", "off_at_end"),
    [(2, 22, 0.02, 0.007), (22, 2, 0.02, 0.007), (5, 105, 0.1, 0.04), (200, 24, 0.1, 0.04)],
)
@pytest.mark.parametrize(
    "bandwidth",
    [{"cutoff_hz": f} for f in (30, 300, 3000)]
    + [{"cutoff_hz": 300, "follower_hz": f} for f in (100, 1000, 20_000)],
)
def test_a_long_frame_does_as_400_short_ones(
    bandwidth: dict[str, float], first: float, last: float, off: float, off_at_end: float, span_us: int
) -> None:
    """Light that begins to change, its logarithm in a straight line from there on: a bend by all of its
    slope. Allowed are shares of the way, where the speed of the pixel doubles or halves and where it grows or
    falls fivefold; up to three times that with a second pole. Half a millisecond is for straight pieces."""
    begin = 10_000
    found = []
    for frames in (1, 400):
        light = (first + 20.0) * ((last + 20.0) / (first + 20.0)) ** np.linspace(0, 1, frames + 1) - 20
        found.append(events_of(light, begin, begin + span_us, **bandwidth))
    several = 3 if len(bandwidth) == 2 else 1
    way = 1e4 * abs(math.log((last + 20) / (first + 20)))
    times = np.arange(begin, begin + span_us, 10)
    long, short = (np.searchsorted(t_us, times) for t_us in found)
    assert abs(long[-1] - short[-1]) <= way * several * off_at_end + 1
    assert np.max(np.abs(long - short)) <= way * (several * off + max(500.0 / span_us, 1 / 64)) + 1


def test_a_source_follower_is_a_second_pole() -> None:
    times = np.arange(100, 12_000, 100.0)
    counts = after_a_step(times, 100, 255, cutoff_hz=300, follower_hz=150)
    fast, slow = tau_us(300, 255), 1e6 / (2 * math.pi * 150)
    change = K1 * math.log(275 / 120)
    expected = change * (1 - (slow * np.exp(-times / slow) - fast * np.exp(-times / fast)) / (slow - fast))
    # the follower takes its input as a straight line over 100 us, a fifth of the faster time constant
    np.testing.assert_allclose(counts[2:] + 0.5, expected[2:], atol=0.01 * change)


def test_fast_flicker_fades() -> None:
    swings = []
    for cutoff_hz in (0, 30):
        parameters = only(
            contrast_response={"k1": K1}, flicker={"frequency_hz": 100, "depth": 0.1},
            photoreceptor_bandwidth={"cutoff_hz": cutoff_hz, "reference_dn": 100},
        )  # fmt: skip
        simulator = Simulator(8, 8, parameters, seed=1)
        simulator.advance(still(100, 8, 8), 0)
        simulator.advance(still(100, 8, 8), 100_000)
        swings.append(
            len(simulator.advance(still(100, 8, 8), 300_000)) / 64 / 40 + 1
        )  # one is lost to turning
    assert swings[1] / swings[0] == pytest.approx(1 / math.hypot(1, 100 / 30), rel=0.03)


def test_a_new_image_after_a_jump_or_a_change_of_parameters_has_no_past() -> None:
    parameters = only(contrast_response={"k1": K1}, photoreceptor_bandwidth={"cutoff_hz": 10})
    simulator = Simulator(SIDE, SIDE, parameters, seed=1)
    simulator.advance(still(100, SIDE, SIDE), 0)
    simulator.jump(still(10, SIDE, SIDE), 500)
    assert len(simulator.advance(still(10, SIDE, SIDE), 100_000)) == 0
    simulator.parameters = parameters.changed({"photoreceptor_bandwidth": {"follower_hz": 10}})
    assert len(simulator.advance(still(10, SIDE, SIDE), 200_000)) == 0


@pytest.mark.parametrize(
    "fast",
    [
        {"cutoff_hz": 1e5, "reference_dn": 0, "dark_dn": 1e-300},
        {"cutoff_hz": 1e5, "reference_dn": 0, "dark_dn": 1e-300, "follower_hz": 1e6},
    ],
)
def test_the_fastest_that_can_be_asked_for_follows_at_once(fast: dict[str, float]) -> None:
    without = net_after_a_step(contrast_response={"k1": K1})
    with_it = net_after_a_step(contrast_response={"k1": K1}, photoreceptor_bandwidth=fast)
    np.testing.assert_allclose(with_it, without, atol=1)


@pytest.mark.parametrize("slow", [{"cutoff_hz": 1e-300}, {"cutoff_hz": 1e5, "follower_hz": 1e-300}])
def test_the_slowest_does_not_move(slow: dict[str, float]) -> None:
    assert not net_after_a_step(contrast_response={"k1": K1}, photoreceptor_bandwidth=slow).any()


def test_voltages_stay_numbers_in_the_hottest_dark_current() -> None:
    hot = {"dark_dn": 1e4, "doubling_c": 1}
    for bandwidth in ({"cutoff_hz": 300}, {"cutoff_hz": 1e5, "dark_dn": 1e4, "follower_hz": 100}):
        parameters = only(
            contrast_response={"k1": K1}, dark_current=hot, photoreceptor_bandwidth=bandwidth,
            temperature_drift={"amplitude_c": 80, "period_s": 0.05},
        )  # fmt: skip
        simulator = Simulator(SIDE, SIDE, parameters, seed=1)
        for k in range(60):
            simulator.advance(still((k % 5) * 60, SIDE, SIDE), k * 17_000)
            assert np.isfinite(simulator.snapshot()["voltage"]).all()


def net_after_a_step(**changes: object) -> NDArray[np.int64]:
    """Net events of each pixel in 0.1 s after light goes from nothing to white."""
    simulator = Simulator(SIDE, SIDE, only(**changes), seed=1)
    net = np.zeros((SIDE, SIDE), np.int64)
    for grey, t_us in ((0, 0), (0, 100_000), (255, 110_000), (255, 200_000)):
        events = simulator.advance(still(grey, SIDE, SIDE), t_us)
        np.add.at(net, (events["y"], events["x"]), np.where(events["p"], 1, -1))
        assert np.isfinite(simulator.snapshot()["voltage"]).all()
    return net
