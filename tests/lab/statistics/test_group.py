"""Labels of a table, bins and sums, against counting one by one."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_lab.statistics import PARTS
from voltcam_lab.statistics.group import bin_numbers, classes, labels, sums, tally

EDGES = (1.0, 5.0, 20.0)
rows = st.lists(st.tuples(st.integers(0, PARTS - 1), st.integers(-1, 4), st.integers(-9, 9)), max_size=50)


def test_labels_are_the_places_of_a_table_the_last_axis_fastest() -> None:
    made = labels("X", "name", "count", ("a", ("1", "2")), ("b", ("3", "4", "5")), floor=2.0)
    assert [[which for _, which in one.strata] for one in made] == [
        [a, b] for a in ("1", "2") for b in ("3", "4", "5")
    ]  # fmt: skip
    assert {(one.group, one.name, one.kind, one.floor) for one in made} == {("X", "name", "count", 2.0)}
    assert str(made[1]) == "X name (a 1, b 4)"
    assert [str(one) for one in labels("X", "alone", "value")] == ["X alone"]


@settings(deadline=None)
@given(st.lists(st.integers(0, 30), max_size=30))
def test_bins_are_those_of_searchsorted_and_each_has_a_name(values: list[int]) -> None:
    x = np.array(values, np.int64)
    assert bin_numbers(x, EDGES).tolist() == np.searchsorted(EDGES, x, side="right").tolist()
    assert classes(EDGES, "ms") == ("below 1 ms", "1 to 5 ms", "5 to 20 ms", "from 20 ms")


@settings(deadline=None)
@given(rows)
def test_tallies_and_sums_are_counted_one_by_one(rows: list[tuple[int, int, int]]) -> None:
    part = np.array([row[0] for row in rows], np.uint8)
    index, weight = (np.array([row[k] for row in rows], np.int64) for k in (1, 2))
    counted, added = np.zeros((PARTS, 5)), np.zeros((PARTS, 5))
    for p, i, w in rows:
        if i >= 0:
            counted[p, i] += 1
            added[p, i] += w
    assert tally(part, index, 5) == pytest.approx(counted)
    assert sums(part, index, weight, 5) == pytest.approx(added)
