"""Kicks of a band row by row, against a slow reading of what they are."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_simulator.effect import Band, Sensor
from voltcam_simulator.kicks import kicks_of, no_kicks

ROWS, WIDTH, SPAN_US = 3, 2, 100.0
TIMES = st.one_of(st.sampled_from([-5.0, 0.0, SPAN_US, SPAN_US + 1, math.inf]), st.floats(0.5, SPAN_US))
SIZES = st.sampled_from([-1.5, -0.25, 0.5, 1.0])
KICKS = st.lists(st.tuples(st.lists(TIMES, min_size=ROWS, max_size=ROWS), SIZES), min_size=1, max_size=5)


def band_with(kicks: list[tuple[list[float], float]]) -> Band:
    ones = np.ones((ROWS, WIDTH), np.float32)
    plane = np.zeros(ROWS * WIDTH, np.float32)
    sensor = Sensor(WIDTH, ROWS, 1, 25.0, 20.0, ones, ones)
    given = [(np.array(times_us, np.float64), size) for times_us, size in kicks]
    return Band(sensor, 0, 0, SPAN_US, 0.0, 25.0, *[plane] * 7, kicks=given)


@given(KICKS)
@settings(max_examples=200, deadline=None)
def test_each_row_has_its_kicks_in_order_of_time(kicks: list[tuple[list[float], float]]) -> None:
    found = kicks_of(band_with(kicks))
    assert found.times_us.shape == found.sizes.shape == (len(kicks), ROWS)
    for row in range(ROWS):
        here = [(times[row], size) for times, size in kicks if 0 < times[row] <= SPAN_US]
        absent = [(math.inf, 0.0)] * (len(kicks) - len(here))
        times_us, sizes = found.times_us[:, row].tolist(), found.sizes[:, row].tolist()
        assert times_us == sorted(times_us)
        assert sorted(zip(times_us, sizes, strict=True)) == sorted(here + absent)
        before = np.cumsum(sizes)
        furthest = np.abs(np.concatenate([before, before[-1] - before])).max()
        slack = found.slack.reshape(ROWS, WIDTH)[row]
        assert slack.tolist() == pytest.approx([furthest] * WIDTH)


def test_a_kick_that_another_one_undoes_has_slack_all_the_same() -> None:
    found = kicks_of(band_with([([20, 20, 20], 0.5), ([60, 60, 60], -0.5)]))
    assert found.sizes.sum() == 0
    assert found.slack.tolist() == [0.5] * (ROWS * WIDTH)


def test_no_kicks_are_of_no_length_and_without_slack() -> None:
    zeros = np.zeros(6, np.float32)
    found = no_kicks(zeros)
    assert len(found.times_us) == len(found.sizes) == 0
    assert found.slack is zeros
