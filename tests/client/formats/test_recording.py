"""What is wrong with events as a recording, and how large a sensor they need."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from voltcam_client.encodings import EVENT, Events
from voltcam_client.formats import recording
from voltcam_client.formats.recording import MAX_T_US, fault_in, smallest_size


def events_of(*rows: tuple[int, int, int]) -> Events:
    return np.array([(t, x, y, True) for t, x, y in rows], EVENT)


def test_the_smallest_sensor_holds_the_farthest_event() -> None:
    assert smallest_size(events_of((0, 3, 0), (1, 0, 7), (2, 1, 1))) == (4, 8)
    assert smallest_size(events_of((0, 65535, 65535))) == (65536, 65536)
    assert smallest_size(events_of()) == (0, 0)


@pytest.mark.parametrize(
    ("row", "fault"),
    [
        ((5, 9, 4), None),
        ((10, 0, 0), None),
        ((4, 0, 0), r"event 2 \(t=4 x=0 y=0\): t goes back: sort"),
        ((-1, 0, 0), "event 2 .*t must be microseconds"),
        ((MAX_T_US, 0, 0), "event 2 .*t must be microseconds"),
        ((6, 10, 0), r"event 2 .*x is outside a width of 10"),
        ((6, 0, 5), r"event 2 .*y is outside a height of 5"),
    ],
)
def test_the_event_at_fault_is_named(row: tuple[int, int, int], fault: str | None) -> None:
    found = fault_in(events_of((1, 0, 0), (5, 0, 0), row, (MAX_T_US - 1, 0, 0)), 10, 5)
    assert (found is None) == (fault is None)
    assert re.match(fault or "", found or ""), found


def test_what_came_before_counts_for_order_and_silence() -> None:
    events = events_of((100, 0, 0), (150, 0, 0))
    assert fault_in(events, 1, 1, after_t_us=100) is None
    assert "event 0" in (fault_in(events, 1, 1, after_t_us=101) or "")
    assert fault_in(events, 1, 1, after_t_us=40, longest_silence_us=60) is None
    assert "event 0" in (fault_in(events, 1, 1, after_t_us=39, longest_silence_us=60) or "")
    assert "event 1" in (fault_in(events, 1, 1, longest_silence_us=49) or "")


def test_a_step_back_from_one_block_to_the_next_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recording, "_BLOCK", 2)
    assert fault_in(events_of((1, 0, 0), (5, 0, 0), (5, 0, 0)), 1, 1) is None
    assert "event 2 (t=3" in (fault_in(events_of((1, 0, 0), (5, 0, 0), (3, 0, 0)), 1, 1) or "")


def test_no_events_have_no_fault() -> None:
    assert fault_in(events_of(), 0, 0) is None


@given(
    st.lists(st.tuples(st.integers(-2, 12), st.integers(0, 4), st.integers(0, 4)), max_size=12),
    st.sampled_from([1, 2, 3, 5, 100]),
)
def test_the_first_fault_is_found_however_events_are_looked_at_in_blocks(
    rows: list[tuple[int, int, int]], block: int
) -> None:
    events, first = events_of(*rows), None
    for i, (t, x, y) in enumerate(rows):
        if t < 0 or x >= 4 or y >= 4 or (i > 0 and t < rows[i - 1][0]):
            first = i
            break
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(recording, "_BLOCK", block)
        found = fault_in(events, 4, 4)
    assert (found is None) == (first is None)
    if found and block == 1:  # in a larger block, the first fault of the kind that is looked for first
        assert found.startswith(f"event {first} ")
