"""The page of the hidden-effects grid, of verdicts that are made by hand."""

import pytest
from tests.hidden_effects.ask import Verdict
from tests.hidden_effects.cases import REPORTED_FROM
from tests.hidden_effects.page import page
from tests.hidden_effects.run import Line

from .made_answers import FLICKER, GRID, answered, as_asked, named


@pytest.fixture(scope="module")
def right() -> list[Line]:
    return [as_asked(case) for case in GRID]


def test_page_tells_what_was_met_and_what_not(right: list[Line]) -> None:
    given = {line.case: line for line in right}
    for case in GRID:
        if case.part == "singles" and case.effects[0] == ("readout", "strong"):
            given[case.name] = answered(case, "refractory_period")
    text = page(GRID, list(given.values()), REPORTED_FROM)
    lines = text.splitlines()
    assert "26 of 28: 93%" in next(line for line in lines if line.startswith("| named, strong"))
    assert "**not met**" in next(line for line in lines if line.startswith("| named, strong"))
    assert "| met |" in next(line for line in lines if line.startswith("| named, weak"))
    assert sum(line.startswith("| singles/readout/strong/") for line in lines) == 2
    assert "Not finished" not in text
    assert f"below {REPORTED_FROM}" in text
    tables = [line for line in lines if line.startswith("|")]
    assert all(line.endswith("|") for line in tables)


def test_page_of_a_part_says_so(right: list[Line]) -> None:
    text = page(GRID, right[:10], REPORTED_FROM)
    assert f"10 of {len(GRID)} cases have run" in text
    assert "not run" in text


def test_page_tells_why_a_good_recording_was_refused() -> None:
    lines = [
        Line(case=name, verdict=Verdict(verdict="refused", reason="too dark"))
        for name in (FLICKER, "shuffled/0")
    ]
    told = page(GRID, lines, REPORTED_FROM).partition("Wrong answers")[2]
    assert "too dark" in told
    assert "shuffled" not in told


def test_page_tells_how_far_a_formula_closes_the_gap() -> None:
    said = Verdict(verdict="unknown", formula="drift += 1", gap_after=2, gap_with_formula=0.5, gap_floor=0.25)
    text = page(GRID, [Line(case="unlisted/root_drift/medium/0", verdict=said)], REPORTED_FROM)
    assert "| root_drift |  | unknown | `drift += 1` (2.00 to 0.50, 0.25) |" in text


def test_confusion_matrix_counts_answers() -> None:
    case = named(FLICKER)
    text = page(GRID, [answered(case, "latency"), answered(named("nulls/0"), verdict="none")], REPORTED_FROM)
    matrix = text.partition("Who was taken")[2]
    assert "|  | hidden | b | none | unknown | refused | crashed |" in matrix
    assert "| a | flicker | 1 | . | . | . | . |" in matrix
    assert "| c | nothing | . | 1 | . | . | . |" in matrix
