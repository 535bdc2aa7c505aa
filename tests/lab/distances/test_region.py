"""Which pixels and times are looked at, and their halves."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.lab.distances.made import WHOLE, stream

from voltcam_lab.distances import (
    Region,
    by_pixels,
    by_time,
    held_out,
)

stretches = st.lists(st.tuples(st.integers(0, 60), st.integers(1, 20)), max_size=6)


@given(keep=stretches, hide=stretches, edges=st.lists(st.integers(0, 90), min_size=2, unique=True))
def test_regions_are_what_counting_microseconds_says(
    keep: list[tuple[int, int]], hide: list[tuple[int, int]], edges: list[int]
) -> None:
    live = np.zeros(100, bool)
    pieces, at = [], 0
    for gap, length in keep:  # stretches are in order and apart
        begin = at + gap % 5
        at = min(begin + length, 90)
        if begin < at:
            pieces.append((begin, at))
            live[begin:at] = True
    windows = np.array([(begin, begin + length) for begin, length in hide], np.int64).reshape(-1, 2)
    for begin, end in windows:
        live[begin:end] = False
    region = Region.whole(2, 1, 0, 100).during(np.array(pieces, np.int64).reshape(-1, 2)).without(windows)
    assert region.pixel_seconds == pytest.approx(2 * live.sum() / 1e6)
    events = stream(np.arange(100), np.zeros(100), np.zeros(100), np.ones(100, bool))
    assert region.of(events)["t"].tolist() == np.flatnonzero(live).tolist()
    edges = sorted(edges)
    counted = [live[first:last].sum() for first, last in pairwise(edges)]
    assert region.live_in(np.array(edges, np.int64)).tolist() == counted
    outside = np.zeros(100, bool)
    for begin, end in region.outside().tolist():
        outside[max(begin, 0) : max(end, 0)] = True
    assert (outside == ~live).all()


def test_halves_share_nothing_and_leave_nothing_out() -> None:
    for first, second in (by_pixels(WHOLE, 12), by_time(WHOLE, 100_000)):
        assert first.pixel_seconds + second.pixel_seconds == pytest.approx(WHOLE.pixel_seconds)
        both = first.on(second.pixels).during(second.times)
        assert both.pixel_seconds == 0
    fitting, judging = held_out(WHOLE)
    assert not (fitting.pixels & judging.pixels).any()
    assert not len(fitting.during(judging.times).times)


def test_what_is_held_out_has_halves_of_its_own() -> None:
    judging = held_out(WHOLE)[1]
    for first, second in (by_pixels(judging, 1), by_pixels(judging, 12), by_time(judging, 100_000)):
        assert first.pixel_seconds == pytest.approx(second.pixel_seconds, rel=0.01)
