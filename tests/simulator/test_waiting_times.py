"""Rows under still light: their events are drawn ahead, and voltages when something changes after all."""

import math

import numpy as np
import pytest
from scipy import stats

from voltcam_simulator import Parameters, Simulator
from voltcam_simulator.groups import AheadRows, Motion, Pixels, Step
from voltcam_simulator.random import AHEAD, BACK, interval_key
from voltcam_simulator.waiting_times import catch_up, draw_ahead

from .scenes import Events, intervals_us, only

P_LIMIT = 1e-4  # chance that a correct sampler would fail one assertion for a random seed


@pytest.mark.parametrize(("mu", "start", "above", "below"), [(1e-6, 0.2, 1.0, 1.0), (-2e-6, 0.3, 2.0, 0.7)])
@pytest.mark.parametrize("share", [0.5, 0.9, 1.1])
def test_who_has_fired_and_where_the_others_stand(
    mu: float, start: float, above: float, below: float, share: float
) -> None:
    """At a share of the mean time to the barrier, d away: a path that has not met it is where its density is
    N(z - m t) - exp(2 m d / sigma^2) N(z - 2 d - m t), z towards the barrier."""
    n, sigma, span, now = 100_000, 1.6e-4, 1000.0, 4096.0
    pixels = Pixels(*(np.full(n, value, np.float32) for value in (start, 0, 0, above, below)))
    motion = Motion(*(np.full(n, value, np.float32) for value in (mu * span, sigma)))
    rows = AheadRows(
        still_steps=np.full(1, 99, np.int32),
        ahead=np.zeros(1, np.bool_),
        drawn_us=np.zeros(1, np.float32),
        since_us=np.zeros(n, np.float32),
        due_us=np.zeros(n, np.float32),
        motion=np.zeros((n, 2), np.float32),
    )
    draw_ahead(*rows, *pixels, *motion, *Step(interval_key(1, AHEAD, 0), span, 0.0, 0, n), now)
    assert rows.ahead.all()
    rows.still_steps[:] = 0
    distance = above - start if mu > 0 else start + below
    passed = round(share * distance / abs(mu))
    catch_up(*rows, *pixels, interval_key(1, BACK, 0), 0, now + passed)
    assert not rows.ahead.any()
    towards, spread = abs(mu) * passed, sigma * math.sqrt(passed)

    def unfired(z: np.ndarray) -> np.ndarray:
        image = 2 * abs(mu) * distance / sigma**2 + stats.norm.logcdf(z - 2 * distance, towards, spread)
        return stats.norm.cdf(z, towards, spread) - np.exp(image)

    waiting = rows.due_us > now + passed
    assert stats.binomtest(int(waiting.sum()), n, float(unfired(np.array(distance)))).pvalue > P_LIMIT
    z = (pixels.voltage[waiting] - start) * np.sign(mu)
    assert stats.kstest(z, lambda z: unfired(z) / unfired(np.array(distance))).pvalue > P_LIMIT


BLIND = only(junction_leak={"k4_per_us": 1e-6}, leak_noise={"k6": 1e-4})
"""The light does nothing, so it may change: intervals are IG(1/k4, 1/k6^2) whatever happens."""


@pytest.mark.parametrize("interruption", ["none", "light", "one row", "parameters", "jump", "dtype", "pause"])
def test_leak_intervals_are_brownian_whatever_comes_in_between(interruption: str) -> None:
    width, height, t_us = 40, 30, 0
    simulator = Simulator(width, height, BLIND, seed=3)
    image, found = np.full((height, width), 100, np.uint8), []
    for i in range(400):
        t_us += 33_333
        if i % 14 == 13:  # eight frames until rows are drawn ahead, then five
            match interruption:
                case "light":
                    image = image ^ 1
                case "one row":
                    image[i % height] ^= 1
                case "parameters":
                    simulator.parameters = BLIND
                case "jump":
                    simulator.jump(image ^ 1, t_us - 33_333)
                case "dtype":
                    image = image.astype(np.float32 if image.dtype == np.uint8 else np.uint8)
                case "pause":
                    t_us += 9_000_000
        found.append(simulator.advance(image, t_us))
    between = intervals_us(np.concatenate(found), width)
    law = stats.invgauss(mu=1e-8 / 1e-6, scale=1e8)
    assert len(between) > 0.9 * (t_us / 1e6 - 1) * width * height
    assert stats.kstest(between, law.cdf).pvalue > P_LIMIT


def test_bands_and_threads_do_not_show_where_a_part_stands_still() -> None:
    def run(threads: int) -> bytes:
        simulator = Simulator(60, 50, Parameters.of("paper"), seed=4, threads=threads)
        image = np.random.default_rng(1).integers(0, 256, (50, 60), np.uint8)
        events: list[Events] = []
        for i in range(60):
            image[:7] += 1
            image[20:30] += np.uint8(i % 20 == 0)
            events.append(simulator.advance(image, 33_333 * i))
        assert len(np.concatenate(events[-5:])) > 300
        return np.concatenate(events).tobytes()

    assert run(1) == run(2) == run(3) == run(50)


def test_rows_that_drift_nowhere_are_followed_all_the_same() -> None:
    """Without drift both barriers are within reach: a mean exit time of theta^2/sigma^2, ON and OFF alike."""
    simulator = Simulator(50, 40, only(leak_noise={"k6": 1e-3}), seed=5)
    image = np.full((40, 50), 90, np.uint8)
    events = np.concatenate([simulator.advance(image, 20_000 * i) for i in range(501)])
    # intervals have the variance 2/3 of their squared mean, so counts 2/3 of their mean
    assert len(events) == pytest.approx(20_000, abs=5 * math.sqrt(20_000 * 2 / 3))
    assert stats.binomtest(int(events["p"].sum()), len(events)).pvalue > P_LIMIT


def test_leak_intervals_across_minutes() -> None:
    """Times are kept as float32 from an epoch that moves on; five minutes are more than it holds."""
    simulator, image = Simulator(20, 15, BLIND, seed=6), np.zeros((15, 20), np.uint8)
    events = np.concatenate([simulator.advance(image, 250_000 * i) for i in range(1201)])
    late = events[events["t"] > 150_000_000]
    law = stats.invgauss(mu=1e-8 / 1e-6, scale=1e8)
    assert stats.kstest(intervals_us(late, 20), law.cdf).pvalue > P_LIMIT
