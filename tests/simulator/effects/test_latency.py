"""Latency by its signature: the same events, later and jittered, the pixel's own in their order."""

import numpy as np
import pytest
from scipy import stats

from voltcam_simulator import Parameters, Simulator

from ..scenes import Events, only, still, watch_still

SIDE = 30


def by_pixel(events: Events) -> Events:
    """Pixel after pixel, each pixel's events as they came."""
    return events[np.argsort(events["y"].astype(int) * SIDE + events["x"], kind="stable")]


@pytest.mark.parametrize("fps", [10, 2000])
def test_delays_are_normal_around_the_mean(fps: float) -> None:
    leak = only(junction_leak={"k4_per_us": 1e-5})
    late = leak.changed({"latency": {"delay_us": 700, "jitter_us": 50}})
    before, after = (watch_still(Simulator(SIDE, SIDE, p, seed=2), 0, 1.1, fps) for p in (leak, late))
    before, after = before[before["t"] < 1_050_000], after[after["t"] < 1_050_000 + 2000]
    before, after = by_pixel(before), by_pixel(after)
    # 10 events a second and pixel, 0.1 s apart: take the first ten of each
    first = [np.concatenate([np.arange(i, i + 10) for i in starts(e)]) for e in (before, after)]
    delays = after["t"][first[1]] - before["t"][first[0]]
    assert len(delays) == 10 * SIDE * SIDE
    assert delays.mean() == pytest.approx(700, abs=5 * 50 / np.sqrt(len(delays)) + 0.1)
    assert delays.std() == pytest.approx(50, rel=0.05)
    some = delays[::10]  # few enough for whole microseconds not to show
    assert stats.kstest(some, stats.norm(700, 50).cdf).pvalue > 1e-4


def starts(events: Events) -> np.ndarray:
    pixel = events["y"].astype(int) * SIDE + events["x"]
    return np.flatnonzero(np.r_[True, np.diff(pixel) != 0])


def flicker(parameters: Parameters, rest_us: int, earliest_us: float = 0) -> Events:
    """Forty frames of 1 ms between dark and bright, and a long still one."""
    simulator = Simulator(SIDE, SIDE, parameters, seed=4)
    frames = [still(20 if i % 2 else 220, SIDE, SIDE) for i in range(40)]
    parts = [simulator.advance(f, 1000 * i) for i, f in enumerate(frames)]
    parts.append(simulator.advance(frames[-1], 39_000 + rest_us))
    for start, part in zip(range(-1000, 39_000, 1000), parts, strict=False):
        assert (part["t"] >= start - earliest_us).all()
        assert (part["t"] <= start + 1000).all()
    return np.concatenate(parts)


@pytest.mark.parametrize(
    ("delay_us", "jitter_us"),
    [(100, 20), (100, 30), (0, 400), (5500, 0), (5500, 3000), (-2500, 0), (-800, 600)],
)
def test_nothing_is_lost_or_reordered_in_a_pixel(delay_us: float, jitter_us: float) -> None:
    base = only(contrast_response={"k1": 4})
    late = base.changed({"latency": {"delay_us": delay_us, "jitter_us": jitter_us}})
    earliest_us = max(4 * jitter_us - delay_us, 0)
    before, after = flicker(base, 100_000), flicker(late, 100_000, earliest_us)
    assert (np.diff(after["t"]) >= 0).all()
    before, after = by_pixel(before), by_pixel(after)
    assert len(before) > 10_000
    for name in ("x", "y", "p"):
        assert (before[name] == after[name]).all()
    assert (after["t"] >= before["t"] - earliest_us).all()
    assert (after["t"] > before["t"] - earliest_us / 2).any()


def test_jitter_is_as_wide_to_both_sides() -> None:
    leak = only(junction_leak={"k4_per_us": 1e-5})
    for delay_us in (0, -3000):
        late = leak.changed({"latency": {"delay_us": delay_us, "jitter_us": 2000}})
        before, after = (
            by_pixel(watch_still(Simulator(SIDE, SIDE, p, seed=2), 0, 1.1, 100)) for p in (leak, late)
        )
        first = [starts(events) + 3 for events in (before, after)]  # of each pixel: 0.1 s apart
        delays = after["t"][first[1]] - before["t"][first[0]]
        assert delays.mean() == pytest.approx(delay_us, abs=5 * 2000 / SIDE)
        assert stats.kstest(delays, stats.norm(delay_us, 2000).cdf).pvalue > 1e-4


def test_the_stream_stays_in_order_when_jitter_begins_and_ends() -> None:
    base = only(contrast_response={"k1": 4}, readout={"event_us": 0.1})
    simulator, stream = Simulator(SIDE, SIDE, base, seed=4), []
    for i, jitter_us in enumerate([0, 0, 300, 300, 2000, 2000, 300, 0, 0, 0, 0]):
        simulator.parameters = base.changed({"latency": {"jitter_us": jitter_us}})
        stream.append(simulator.advance(still(20 if i % 2 else 220, SIDE, SIDE), 1000 * i))
    events = np.concatenate(stream)
    assert (np.diff(events["t"]) >= 0).all()
    assert len(events) > 20_000


def test_what_waits_still_comes_after_it_is_switched_off_but_not_after_a_jump() -> None:
    late = only(contrast_response={"k1": 4}, latency={"delay_us": 50_000})
    totals = []
    for jump in (False, True):
        simulator = Simulator(SIDE, SIDE, late, seed=4)
        simulator.advance(still(20, SIDE, SIDE), 0)
        assert len(simulator.advance(still(220, SIDE, SIDE), 1000)) == 0
        simulator.parameters = late.changed({"latency": {"delay_us": 0}})
        if jump:
            simulator.jump(still(220, SIDE, SIDE), -500_000)
        totals.append(len(simulator.advance(still(220, SIDE, SIDE), 100_000)))
    assert totals[0] > 5 * SIDE * SIDE
    assert totals[1] == 0
