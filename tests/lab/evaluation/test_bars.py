"""The figures to beat, and whether they are."""

import pytest

from voltcam_lab.distances import HEADLINES
from voltcam_lab.distances.measures import MEASURES
from voltcam_lab.evaluation.bars import B4, KNOWN, OURS, held_to

FLOOR = dict(zip(HEADLINES, (0.01, 0.02, 0.03, 0.98, 0.52), strict=True))


def rows_of(table: str) -> dict[str, list[str]]:
    """{measure: its cells}."""
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()[2:]]
    return {first: rest for first, *rest in cells}


def own(name: str, share: float) -> dict[str, float]:
    """As far from the best as the bar is, times a share."""
    found = {}
    for measure in HEADLINES:
        best = MEASURES[measure].best or 0.0
        found[measure] = best + share * (KNOWN[name].bar(measure) - best)
    return found


@pytest.mark.parametrize("name", KNOWN)
def test_bars_are_half_way_to_the_floor_but_for_b4(name: str) -> None:
    known = KNOWN[name]
    for measure in HEADLINES:
        if measure == "b4":
            assert known.bar(measure) == B4
        else:
            ends = sorted([known.published[measure], known.floor[measure]])
            assert known.bar(measure) - ends[0] == pytest.approx(ends[1] - known.bar(measure))


@pytest.mark.parametrize("name", KNOWN)
@pytest.mark.parametrize(("share", "met"), [(0.99, "yes"), (1.01, "no"), (-0.99, "yes"), (-1.01, "no")])
def test_a_bar_is_met_from_either_side_of_the_best(name: str, share: float, met: str) -> None:
    table = rows_of(held_to(name, {OURS: own(name, share)}, FLOOR))
    assert list(table) == list(HEADLINES)
    assert {cells[3] for cells in table.values()} == {met}


def test_each_line_has_its_own_numbers_and_who_is_closest() -> None:
    other = own("slider_depth", 0.5)
    table = rows_of(held_to("slider_depth", {OURS: own("slider_depth", 0.9), "esim": other}, FLOOR))
    assert table["W1"][0] == "0.058"
    assert float(table["W1"][1]) == pytest.approx(0.03)
    assert float(table["W1"][2]) == pytest.approx(0.027)
    assert [cells[4] for cells in table.values()] == [f"{FLOOR[measure]:.3g}" for measure in HEADLINES]
    assert {cells[5] for cells in table.values()} == {"esim"}


def test_other_recordings_and_other_models_have_no_bars() -> None:
    assert held_to("mine", {OURS: own("slider_depth", 1)}, FLOOR) == ""
    assert held_to("slider_depth", {"esim": own("slider_depth", 1)}, FLOOR) == ""
