"""Group D: the bus that all pixels share, and the clock.

Bounds are 4.5 standard deviations or more wide: another seed would fail once in 100 000 times.
"""

from itertools import groupby

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_lab.statistics import Setting
from voltcam_lab.statistics.readout import MODULI, runs, since

from .streams import WIDTH, brightening, poisson, seen, still, stream

SECONDS = 8.0


@pytest.fixture(scope="module")
def rest() -> Setting:
    return still(SECONDS)


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


@settings(deadline=None)
@given(st.lists(st.tuples(st.integers(0, 12), st.integers(0, 2)), min_size=1, max_size=40))
def test_time_since_the_last_other_stamp_of_a_lane_one_by_one(rows: list[tuple[int, int]]) -> None:
    rows = sorted(rows)
    t_us, lane = np.array(rows, np.int64).T.copy()
    found = since(t_us, lane, 3)
    for i, (t, k) in enumerate(rows):
        before = [other for other, of in rows[:i] if of == k and other < t]
        if before:
            assert found[i] == t - before[-1]
        else:
            assert found[i] > 1 << 50


@settings(deadline=None)
@given(st.lists(st.integers(0, 3), min_size=1, max_size=30))
def test_runs_are_as_long_as_their_groups(keys: list[int]) -> None:
    wanted = [length for _, group in groupby(keys) for length in [len(list(group))] for _ in range(length)]
    assert runs(np.array(keys, np.int64)).tolist() == wanted


def test_times_are_divisible_by_what_divides_them(rest: Setting) -> None:
    t_us = np.random.default_rng(17).integers(1, 8_000_000, 3000)
    n = seen(rest, stream(t_us, 0), "D", "t divisible")
    assert n.tolist() == [(t_us % m == 0).sum() for _, moduli in MODULI for m in moduli]
