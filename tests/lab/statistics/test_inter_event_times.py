"""Group B: intervals between events of a pixel.

Bounds are 4.5 standard deviations or more wide: another seed would fail once in 100 000 times.
"""

from collections import Counter

import numpy as np
import pytest

from voltcam_lab.statistics import Setting
from voltcam_lab.statistics.inter_event_times import COARSE_MS

from .streams import PIXELS, brightening, poisson, seen, still, stream

SECONDS = 8.0


@pytest.fixture(scope="module")
def rest() -> Setting:
    return still(SECONDS)


@pytest.fixture(scope="module")
def rise() -> Setting:
    return brightening(2.0)


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


def test_each_pair_of_polarities_is_counted_once_one_by_one(rest: Setting, rise: Setting) -> None:
    """Against a slow count over pixels; while moving, pairs of one polarity are in finer bins."""
    rng = np.random.default_rng(12)
    events = poisson(rng, 6.0, 2.0)
    events["p"] = rng.random(len(events)) < 0.4
    counted: Counter[str] = Counter()
    last: dict[tuple[int, int], bool] = {}
    for t, x, y, on in np.sort(events, order=["t", "y", "x", "p"]).tolist():
        if t == 0 or t > 2_000_000:
            continue
        if (x, y) in last:
            counted[f"{'ON' if last[x, y] else 'OFF'} {'ON' if on else 'OFF'}"] += 1
        last[x, y] = on
    for pair, n in counted.items():
        assert seen(rest, events, "B", "intervals", f"{pair} at rest").sum() == n
        first, second = pair.split()
        if first != second:
            assert seen(rise, events, "B", "intervals", f"{pair} moving").sum() == n
        else:
            assert seen(rise, events, "B", "intervals, moving", first).sum() == n


def test_an_interval_is_in_the_bin_of_its_length(rest: Setting) -> None:
    """The ends of bins belong to the bin above."""
    edges_us = [1000 * edge for edge in COARSE_MS]
    for span_us in [1, 999, *(int(edge) + d for edge in edges_us for d in (-1, 0))]:
        n = seen(rest, stream([10, 10 + span_us], [5, 5]), "B", "intervals", "ON ON at rest")
        assert np.flatnonzero(n).tolist() == [sum(span_us >= edge for edge in edges_us)]
