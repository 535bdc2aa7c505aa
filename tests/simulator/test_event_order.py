"""Events in order of time, against numpy's stable sort."""

import numpy as np
import pytest

from voltcam_simulator import EVENT
from voltcam_simulator.effect import Events
from voltcam_simulator.event_order import copied, events_at, in_time_order, merged


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


def test_pixels_are_numbered_row_by_row() -> None:
    events = events_at(np.array([7, 3]), np.array([13, 4]), np.array([True, False]), width=5)
    assert events.tolist() == [(3, 4, 0, False), (7, 3, 2, True)]


def test_a_copy_is_on_memory_of_its_own() -> None:
    events = some(10, 3)
    copy = copied(events)
    np.testing.assert_array_equal(copy, events)
    copy["x"] = 99
    assert events["x"].tolist() == list(range(10))
