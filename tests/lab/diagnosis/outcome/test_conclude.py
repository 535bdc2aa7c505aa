"""The verdict in a sentence and sizes with their intervals, of a search that is written down."""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_lab.diagnosis.outcome.conclude import sentence
from voltcam_lab.diagnosis.outcome.where import View
from voltcam_lab.diagnosis.search.evidence import Evidence
from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.loop import Diagnosis, Found
from voltcam_lab.diagnosis.search.settings import DEFAULTS
from voltcam_lab.diagnosis.search.unlisted import ResidualTerm
from voltcam_lab.statistics import PARTS

from ..made_rig import DEAD_TIME, MISMATCH, START
from ..made_steps import N, step, trial


def view(held_out: float) -> View:
    before = step(4.0)
    return View(
        before.hypothesis, before.screen.spread, np.zeros((PARTS, N)), held_out, 0.5, 0.0, DEFAULTS.huber_z
    )


MOST = -np.log(DEFAULTS.alarm) * (DEFAULTS.naming.light + 4 * DEFAULTS.naming.form)  # of a gap of 4
BEFORE, AFTER = view(4.5), view(0.6)
SEEN = step(4.0, trial(DEAD_TIME, 0.1), trial(MISMATCH, 2.0))


def found(*rivals: str, left: float = 0.1) -> Diagnosis:
    one = Found(trial(DEAD_TIME, 0.1), SEEN, rivals, Evidence(5.0, 0.001))
    last = step(left, added=DEAD_TIME)
    return Diagnosis("effects", (one,), last.hypothesis, (SEEN, last))


def test_a_missing_effect_is_named_with_the_fall_of_the_gap() -> None:
    assert sentence(found(), BEFORE, AFTER) == (
        "The camera file lacks refractory period. With that added, the gap to the measurement on held-out "
        "data falls from 4.50 to 0.60, where chance alone leaves 0.50."
    )


def test_rivals_are_named_beside_it() -> None:
    said = sentence(found("threshold_mismatch", "hot_pixels"), BEFORE, AFTER)
    assert (
        "refractory period (or threshold mismatch or hot pixels, which explain this recording as well)"
        in said
    )


@pytest.mark.parametrize("over", [-0.01, 0.01])
def test_what_is_left_is_said(over: float) -> None:
    said = sentence(found(left=MOST + over), BEFORE, AFTER)
    assert ("What is left has no name in the catalogue." in said) == (over > 0)


def test_where_nothing_is_missing_chance_is_what_is_left() -> None:
    nothing = Diagnosis("none", (), Hypothesis(START), (step(0.1),))
    said = sentence(nothing, AFTER, AFTER)
    assert said.startswith("Nothing is missing: ")
    assert said.endswith(
        "data is 0.60, where chance leaves 0.50 and the light between frames up to 0.30 more."
    )


def test_of_what_has_no_name_the_nearest_effect_and_a_formula_are_said() -> None:
    unknown = Diagnosis("unknown", (), Hypothesis(START), (SEEN,))
    said = sentence(unknown, BEFORE, BEFORE)
    assert "is 4.50, chance alone would leave 0.50." in said
    assert said.endswith("Refractory period comes nearest, and leaves 0.60.")
    term = ResidualTerm(trial(MISMATCH, 0.1), "drift += 1e-07/us", (), SEEN)
    said = sentence(replace(unknown, residual=term), BEFORE, AFTER)
    assert "falls from 4.50 to 0.60" in said
    assert said.endswith("A term of unknown origin, drift += 1e-07/us, explains part of it.")
