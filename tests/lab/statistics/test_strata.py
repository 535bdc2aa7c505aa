"""How bright light is and how it changes, of steps written down."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_lab.statistics.strata import INTENSITIES, LULL, REST, SLOPES, light_strata, weighted_median

from .streams import PERIOD_US

weights = st.lists(st.tuples(st.integers(0, 50), st.integers(1, 9)), min_size=1, max_size=20)


@settings(deadline=None)
@given(weights)
def test_half_of_the_weight_lies_below_the_weighted_median(pairs: list[tuple[int, int]]) -> None:
    values, weight = np.array(pairs, float).T
    found = weighted_median(values, weight)
    assert found in values
    assert weight[values < found].sum() <= weight.sum() / 2 <= weight[values <= found].sum()


def strata(grey: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """(intensity, slope) of each pixel (K,) and step, and the speed that divides slow from fast."""
    light = np.ascontiguousarray(grey.T, np.float32)
    t_us = np.arange(len(light)) * PERIOD_US
    found = light_strata(light, np.log(light + 20), t_us)
    return (*np.divmod(found.index.T, SLOPES), found.fast_per_s)


def test_shares_of_pixels_and_time_are_those_of_the_edges() -> None:
    """A tenth darkest, a fifth dark, a quarter, a quarter, a fifth brightest; all at rest."""
    intensity, slope, _ = strata(np.repeat(np.linspace(5, 250, 200)[:, None], 30, axis=1))
    shares = np.bincount(intensity.ravel(), minlength=INTENSITIES) / intensity.size
    assert shares == pytest.approx([0.1, 0.2, 0.25, 0.25, 0.2], abs=0.011)
    assert (np.diff(intensity[:, 0].astype(int)) >= 0).all()
    assert (slope == REST).all()


def test_half_of_all_change_is_faster_than_fast() -> None:
    """Each pixel has a speed of its own, up or down; every class is the one of its slope."""
    speed = np.linspace(0.9, 3, 40) * np.where(np.arange(40) % 2, 1, -1)  # faster than rest
    log = np.log(80) + speed[:, None] * np.arange(60) * PERIOD_US * 1e-6
    _, slope, fast = strata(np.exp(log) - 20)
    change = np.abs(speed)
    assert change[change < fast].sum() == pytest.approx(change.sum() / 2, rel=0.1)
    wanted = np.where(change < fast, np.sign(speed) + LULL, 2 * np.sign(speed) + LULL)
    assert (slope[:, 5:-5] == wanted[:, None]).all()


def test_light_that_halts_is_in_a_lull_before_it_is_at_rest() -> None:
    log = np.log(80) + np.minimum(np.arange(100), 50) * 0.02 * np.ones((3, 1))
    _, slope, _ = strata(np.exp(log) - 20)
    assert LULL not in slope[:, :50]
    halted = slope[0, 50:]
    assert halted[0] == LULL
    assert halted[-1] == REST
    assert (np.diff((halted == REST).astype(int)) >= 0).all()  # and stays at rest
