from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from voltcam_video.interval import instants


@given(st.integers(0, 2**60), st.integers(1, 10**10), st.integers(1, 100))
def test_steps_are_even_to_the_microsecond(start_us: int, span_us: int, steps: int) -> None:
    between = list(instants(start_us, start_us + span_us, steps))
    times_us = [start_us, *(t_us for t_us, _ in between), start_us + span_us]
    lengths_us = [late - early for early, late in pairwise(times_us)]
    assert len(lengths_us) == min(steps, span_us)
    assert min(lengths_us) >= 1
    assert max(lengths_us) - min(lengths_us) <= 1
    assert all(gone == (t_us - start_us) / span_us for t_us, gone in between)


@pytest.mark.parametrize("end_us", [5, 4])
def test_nothing_where_time_does_not_advance(end_us: int) -> None:
    assert list(instants(5, end_us, 8)) == []
