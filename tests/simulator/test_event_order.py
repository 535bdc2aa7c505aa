"""Events in order of time, against numpy's stable sort."""

import numpy as np
import pytest

from voltcam_simulator import EVENT
from voltcam_simulator.effect import Events
from voltcam_simulator.event_order import copied, in_time_order, merged


def some(count: int, seed: int, span_us: int = 50) -> Events:
    """Many of one time; x counts them, so that their order can be told."""
    events = np.zeros(count, EVENT)
    events["t"] = np.random.default_rng(seed).integers(-span_us, span_us, count)
    events["x"] = np.arange(count)
    return events


@pytest.mark.parametrize("count", [0, 1, 2, 3, 1000])
def test_sorting_keeps_the_order_of_events_of_one_time(count: int) -> None:
    events = some(count, count)
    expected = events[np.argsort(events["t"], kind="stable")]
    np.testing.assert_array_equal(in_time_order(events), expected)


@pytest.mark.parametrize(("first", "second"), [(0, 5), (5, 0), (700, 300)])
def test_merging_is_sorting_both_with_the_first_s_first(first: int, second: int) -> None:
    one, other = in_time_order(some(first, 1)), in_time_order(some(second, 2))
    both = np.concatenate([one, other])
    np.testing.assert_array_equal(merged(one, other), both[np.argsort(both["t"], kind="stable")])


def test_a_copy_is_on_memory_of_its_own() -> None:
    events = some(10, 3)
    copy = copied(events)
    np.testing.assert_array_equal(copy, events)
    copy["x"] = 99
    assert events["x"].tolist() == list(range(10))


@pytest.mark.parametrize("span_us", [1, 3000, 100_000])
def test_sorting_does_not_depend_on_how_dense_events_are(span_us: int) -> None:
    events = some(1000, 7, span_us)
    events["t"] += 1_700_000_000_000_000
    expected = events[np.argsort(events["t"], kind="stable")]
    np.testing.assert_array_equal(in_time_order(events), expected)
