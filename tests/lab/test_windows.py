"""Windows against a time line of single microseconds."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from voltcam_lab.windows import (
    Mask,
    around,
    common,
    complement,
    joined,
    number_of,
    overlap_us,
    total_us,
    within,
)

END = 60
LINE = np.arange(END)
span = st.tuples(st.integers(0, END - 1), st.integers(1, 12)).map(lambda s: (s[0], min(s[0] + s[1], END)))
lists = st.lists(span)


def on_line(windows: np.ndarray) -> np.ndarray:
    """(END,): which microseconds they cover."""
    line = np.zeros(END, bool)
    for begin, end in windows:
        line[max(begin, 0) : max(min(end, END), 0)] = True
    return line


@given(lists, st.integers(0, 5))
def test_joined_are_in_order_and_further_apart_than_the_gap(
    given_spans: list[tuple[int, int]], gap: int
) -> None:
    windows = joined(given_spans, gap)
    assert (windows[:, 0] < windows[:, 1]).all()
    assert (windows[1:, 0] - windows[:-1, 1] > gap).all()
    assert (on_line(windows) >= on_line(np.reshape(given_spans, (-1, 2)))).all()
    if gap == 0:
        assert (on_line(windows) == on_line(np.reshape(given_spans, (-1, 2)))).all()


@given(lists, lists)
def test_arithmetic_is_that_of_sets(first: list[tuple[int, int]], second: list[tuple[int, int]]) -> None:
    a, b = joined(first), joined(second)
    assert (within(LINE, a) == on_line(a)).all()
    assert (on_line(common(a, b)) == (on_line(a) & on_line(b))).all()
    assert (on_line(complement(a)) == ~on_line(a)).all()
    assert total_us(a) == on_line(a).sum()
    edges = np.array([0, 7, 30, END])
    wanted = [on_line(a)[begin:end].sum() for begin, end in pairwise(edges)]
    assert overlap_us(a, edges).tolist() == wanted
    assert overlap_us(complement(a), edges).tolist() == (np.diff(edges) - wanted).tolist()
    number = number_of(LINE, a)
    for t in LINE[number >= 0]:
        begin, end = a[number[t]]
        assert begin <= t < end


def test_spans_about_times() -> None:
    windows = around(np.array([100, 110, 200]), np.array([[-5, 5], [8, 9]]))
    assert windows.tolist() == [[95, 115], [118, 119], [195, 205], [208, 209]]


def test_ends_of_stretches_that_touch_are_kept_in_what_is_common() -> None:
    stretches = np.array([[0, 10], [10, 20]])
    assert common(stretches, np.array([[5, 15]])).tolist() == [[5, 10], [10, 15]]


def test_a_row_s_windows_come_later() -> None:
    mask = Mask(np.array([[50, 60]]), np.array([[0, 10]]), us_per_row=2.5)
    t_us, y = np.array([9.0, 9.0, 19.9, 20.0, 55.0, 70.0]), np.array([0, 4, 4, 4, 1, 1])
    assert mask.start(t_us, y).tolist() == [0.0, 9.0, 10.0, 20.0, 50.0, 70.0]
    assert mask.share(0, 100) == pytest.approx(0.2)
    assert mask.from_row(4).start(t_us, y - 4)[2] == 10.0


def test_what_is_fitted_is_less_what_is_masked() -> None:
    mask = Mask(np.array([[50, 60]]), np.array([[0, 10]]), us_per_row=2.5).only(np.array([[40, 80]]))
    assert within(np.array([39, 40, 49, 50, 60, 79, 80]), mask.windows).tolist() == [
        True, False, False, True, False, False, True,
    ]  # fmt: skip
    assert mask.us_per_row == 2.5
