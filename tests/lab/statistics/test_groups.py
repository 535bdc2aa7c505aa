"""Each group against closed forms, on streams made by hand.

Random ones have fixed seeds; each bound is 4.5 standard deviations or more wide, so that another seed would
fail once in 100 000 times.
"""

import numpy as np
import pytest

from voltcam_lab.statistics import Setting
from voltcam_lab.statistics.inter_event_times import COARSE_MS

from .streams import HEIGHT, PERIOD_US, PIXELS, WIDTH, brightening, poisson, seen, still, stream

SECONDS = 8.0


@pytest.fixture(scope="module")
def rest() -> Setting:
    return still(SECONDS)


@pytest.fixture(scope="module")
def rise() -> Setting:
    return brightening(2.0)


def test_rates_count_by_polarity_and_state(rest: Setting, rise: Setting) -> None:
    events = np.concatenate([stream([600_000] * 3, [0, 1, 2]), stream([700_000] * 2, [3, 4], False)])
    assert seen(rest, events, "A", "events", "ON", "rest").sum() == 3
    assert seen(rest, events, "A", "events", "OFF", "rest").sum() == 2
    assert seen(rise, events, "A", "events", "rest").sum() == 0
    assert seen(rise, events, "A", "events", "ON").sum() == 3


def test_intensity_goes_with_the_light(rise: Setting) -> None:
    early, late = stream([50_000], [7]), stream([1_950_000], [7])
    assert seen(rise, early, "A", "events", "darkest").sum() == 1
    assert seen(rise, late, "A", "events", "brightest").sum() == 1


def test_poisson_intervals_are_exponential(rest: Setting) -> None:
    rate_hz = 20.0
    n = seen(rest, poisson(np.random.default_rng(1), rate_hz), "B", "intervals", "ON ON at rest")
    edges_s = np.array([0, *COARSE_MS]) * 1e-3
    expected = n.sum() * np.diff(np.append(-np.exp(-rate_hz * edges_s), 0))
    well = expected > 20
    assert (np.abs(n - expected)[well] < 5 * np.sqrt(expected[well])).all()


def test_regular_intervals_have_ratio_one(rise: Setting) -> None:
    t_us, pixel = np.meshgrid(np.arange(15_000, 2_000_000, 15_000), np.arange(PIXELS))
    ratios = seen(rise, stream(t_us, pixel), "B", "two intervals in succession, moving", "ON")
    assert ratios[0] == PIXELS * (t_us.shape[1] - 2)
    assert ratios[1:].sum() == 0


def test_only_what_lasts_differs_twice(rest: Setting) -> None:
    rng = np.random.default_rng(2)
    alike = seen(rest, poisson(rng, 4.0), "C", "differs twice", "ON at rest x ON at rest")
    unlike = seen(
        rest, poisson(rng, 4 * rng.gamma(4, 0.25, PIXELS)), "C", "differs twice", "ON at rest x ON at rest"
    )
    assert abs(alike[0]) < 4.5 * np.sqrt(PIXELS)
    assert unlike[0] > 10 * np.sqrt(PIXELS)  # (4 Hz x 4 s x 2 parts)/4 variance for each pixel


def test_hot_and_dead_pixels_are_counted(rest: Setting) -> None:
    rate_hz = np.full(PIXELS, 3.0)
    rate_hz[[50, 200]], rate_hz[[77, 111, 300]] = 50, 0
    events = poisson(np.random.default_rng(3), rate_hz)
    assert seen(rest, events, "C", "pixels far above", "ON at rest", "16")[0] == 4  # in both parts of time
    assert seen(rest, events, "C", "silent pixels", "6")[0] == 6


def test_shared_stamps_gaps_and_crowds(rest: Setting) -> None:
    events = stream([1000, 1000, 1000, 1030, 1100], [0, 1, WIDTH, 5, 6])
    assert seen(rest, events, "D", "shares its stamp", "its row")[0] == 2
    assert seen(rest, events, "D", "shares its stamp", "another row")[0] == 1
    assert seen(rest, events, "D", "time since the array's last stamp", "25 to 40 us")[0] == 1
    assert seen(rest, events, "D", "time since the array's last stamp", "60 to 100 us")[0] == 1
    assert seen(rest, events, "D", "crowd within 250 us", "4 to 8 events")[0] == 5


def test_ticks_of_a_coarse_clock(rest: Setting) -> None:
    events = poisson(np.random.default_rng(4), 5.0)
    fine = seen(rest, events, "D", "t divisible", "10 us")[0]
    events["t"] = events["t"] // 10 * 10
    assert abs(fine - len(events) / 10) < 4.5 * np.sqrt(0.09 * len(events))
    assert seen(rest, events, "D", "t divisible", "10 us")[0] == (events["t"] > 0).sum()
    assert seen(rest, events, "D", "t divisible", "5 us")[0] == (events["t"] > 0).sum()


def test_holes_are_silent_milliseconds_of_a_busy_scene(rest: Setting) -> None:
    busy = brightening(0.6, 4.0)  # 4.5 events a millisecond on each half of the tiles, by the model
    events = poisson(np.random.default_rng(5), 100.0, 0.6)
    hole = (events["t"] > 300_000) & (events["t"] <= 320_000)
    assert seen(busy, events, "D", "silent milliseconds", "3")[0] == 0
    assert seen(busy, events[~hole], "D", "silent milliseconds", "3")[0] == 40
    assert seen(rest, events[~hole], "D", "silent milliseconds", "3")[0] == 0


def test_flicker_stands_in_its_band(rest: Setting) -> None:
    rng, depth = np.random.default_rng(6), 0.5
    events = np.concatenate([poisson(rng, 10.0, on=True), poisson(rng, 10.0, on=False)])
    turn = np.where(events["p"], 1, -1) * np.sin(2 * np.pi * 100.03 * events["t"] * 1e-6)
    kept = events[rng.random(len(events)) < (1 + depth * turn) / (1 + depth)]
    amplitude = seen(rest, kept, "E", "largest amplitude of ON - OFF", "95 to 105 Hz", "rest")[0]
    beside = seen(rest, kept, "E", "largest amplitude of ON - OFF", "125 to 200 Hz", "rest")[0]
    expected = 4 * depth / 2 * np.sqrt(len(kept) / 4)  # each of four parts
    assert 0.85 * expected < amplitude < 1.02 * expected  # a tenth is lost between two frequencies
    assert beside < 4 * np.sqrt(np.log(150 * 8 * 1e6))  # largest of some 1200 exponential powers


def test_phase_in_frame(rest: Setting) -> None:
    rng = np.random.default_rng(7)
    events = poisson(rng, 5.0)
    locked = events.copy()
    locked["t"] = locked["t"] // PERIOD_US * PERIOD_US + 3010 + rng.integers(0, 20, len(events))
    assert seen(rest, locked, "F", "events", "ON", "rest", "2/8")[0] == len(events)
    free, tight = (seen(rest, e, "F", "crowding in phase", "ON", "rest")[0] for e in (events, locked))
    assert free == pytest.approx(4, abs=4 * 4.5 * np.sqrt(2 * 256) / (len(events) / 4))
    assert tight > 4 * 250


def test_trend_follows_the_rate(rest: Setting) -> None:
    rng = np.random.default_rng(8)
    events = poisson(rng, 10.0)
    warming = events[rng.random(len(events)) < events["t"] / 8e6]
    n = seen(rest, warming, "G", "events at rest", "ON")
    expected = 80 * PIXELS * (2 * np.arange(6) + 1) / 72
    assert (np.abs(n - expected) < 4.5 * np.sqrt(expected)).all()


def test_lag_response_is_slope_times_span(rise: Setting) -> None:
    events = poisson(np.random.default_rng(9), 20.0, 2.0)
    events = events[(events["t"] > 100_000) & (events["t"] < 1_900_000)]
    for lag, span_s in (("-2 to 0 ms", 2e-3), ("0.2 to 0.5 ms", 3e-4), ("12 to 40 ms", 28e-3)):
        total = seen(rise, events, "H", "change before events", lag).sum()
        assert total == pytest.approx(1.15 * span_s * len(events), rel=0.02)


def test_neighbours_only_next_to_each_other(rest: Setting) -> None:
    middle = 5 * WIDTH + 5
    pair = stream([1000, 1100], [middle, middle + 1])
    apart = stream([1000, 1100], [middle, middle + 2])
    edge = stream([1000, 1100], [WIDTH - 1, WIDTH])  # ends of two rows
    names = ("I", "a neighbour just before")
    assert seen(rest, pair, *names, "same polarity", "0.002 to 0.2 ms").sum() == 1
    assert seen(rest, pair, *names).sum() == 1
    assert seen(rest, apart, *names).sum() == seen(rest, edge, *names).sum() == 0
    assert seen(rest, stream(1000, [middle, middle + 1]), *names, "below 0.002 ms").sum() == 2


def test_lines_that_differ(rest: Setting) -> None:
    rate_hz = np.full((HEIGHT, WIDTH), 5.0)
    even = seen(
        rest, poisson(np.random.default_rng(10), rate_hz.ravel()), "I", "spread over lines", "at rest"
    )
    rate_hz[7] *= 2
    uneven = seen(
        rest, poisson(np.random.default_rng(10), rate_hz.ravel()), "I", "spread over lines", "at rest"
    )
    assert even[0] < 4 * (HEIGHT + 4.5 * np.sqrt(2 * HEIGHT))  # chi squared in each part
    assert uneven[0] > 2 * even[0]
    assert uneven[1] < 0.6 * uneven[0]
