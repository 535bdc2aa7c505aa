"""Where model and measurement disagree, of statistics that are drawn."""

import numpy as np
import pytest
from scipy.stats import t

from voltcam_lab.diagnosis.outcome.where import View, gaps_by_group, label_in_words, numbers, ranked
from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.robust import mean_huber
from voltcam_lab.diagnosis.search.settings import DEFAULTS
from voltcam_lab.diagnosis.search.spread import TwinSpread
from voltcam_lab.statistics import COUNTS, FLOORS, LABELS, PARTS, Label, Values

from ..made_rig import START

N, TWINS = len(LABELS), 28
SD = np.maximum(FLOORS, 1)


def drawn(rng: np.random.Generator) -> Values:
    """Statistics about 40: of counts, 400 events."""
    return 40 + SD * rng.standard_normal((PARTS, N))


def view(model_error: float = 0.0) -> View:
    rng = np.random.default_rng(1)
    twins = [drawn(rng) for _ in range(TWINS)]
    mean, sd = np.mean(twins, axis=0), np.broadcast_to(SD, (PARTS, N))
    none = np.zeros((PARTS, N))
    spread = TwinSpread(mean, sd, none, sd, twins, none[..., None], 4, none)
    return View(Hypothesis(START), spread, mean, 1.0, 0.5, model_error, DEFAULTS.huber_z)


MODEL = view()


def test_what_twins_would_give_is_within_chance() -> None:
    """Each z is Student's; of all, few are beyond a false discovery rate of a tenth. Wrong: about 1e-4."""
    found = ranked(MODEL, drawn(np.random.default_rng(2)))
    beyond = np.abs(found.z) > t.ppf(0.975, TWINS - 1)
    assert np.count_nonzero(beyond) < 0.05 * N + 4 * np.sqrt(0.05 * N)
    assert np.count_nonzero(found.q < 0.1) <= 2


def test_a_statistic_that_is_off_comes_first_and_is_reported() -> None:
    data = drawn(np.random.default_rng(3))
    data[:, 17] += 6 * SD[17]
    found = ranked(MODEL, data)
    assert found.order()[0] == 17
    assert found.q[17] < 0.01
    assert found.z[17] > 8  # 12 sd of a mean of four parts, of which twins tell the sd
    assert (np.diff(np.abs(found.z)[found.order()]) <= 0).all()


def test_differences_are_shares_of_counts_and_values_as_they_are() -> None:
    """Twice the events of each part, or a value that is more by 2 in each."""
    once = MODEL.spread.mean
    twice = np.where(COUNTS, 2 * np.sqrt(2 * numbers(once) + 0.375), once + 2)
    found = ranked(MODEL, twice)
    assert found.difference[COUNTS] == pytest.approx(1, abs=0.02)
    assert found.difference[~COUNTS] == pytest.approx(2 * PARTS)
    assert (found.low <= found.difference).all()
    assert (found.difference <= found.high).all()
    assert found.measured[COUNTS] == pytest.approx(2 * found.expected[COUNTS])
    assert found.expected[~COUNTS] == pytest.approx(once[:, ~COUNTS].sum(axis=0))


def test_what_a_model_is_off_by_widens_and_does_not_move() -> None:
    data = drawn(np.random.default_rng(4))
    sure, unsure = ranked(MODEL, data), ranked(view(0.1), data)
    np.testing.assert_array_equal(sure.difference, unsure.difference)
    assert (np.abs(unsure.z) < np.abs(sure.z)).all()
    assert (unsure.high - unsure.low > sure.high - sure.low).all()


def test_of_fewer_events_than_none_there_is_none() -> None:
    """An interval of a count ends at -100 %."""
    found = ranked(MODEL, np.zeros((PARTS, N)))
    assert found.low[COUNTS].min() == pytest.approx(-1)


def test_counts_come_back_from_what_is_compared() -> None:
    counts = np.arange(N, dtype=float)
    assert numbers(np.where(COUNTS, 2 * np.sqrt(counts + 0.375), counts)) == pytest.approx(counts)
    assert (numbers(np.zeros(N)) == 0).all()


def test_each_group_has_its_own_gap_of_the_held_out_part() -> None:
    data = MODEL.spread.mean.copy()
    in_group = np.array([label.group == "E" for label in LABELS])
    data[3, in_group] += 4 * SD[in_group]
    data[:3] += 9  # training parts do not count
    gaps = gaps_by_group(MODEL, data)
    assert list(gaps) == list("ABCDEFGHIJKL")
    for letter, (gap, chance) in gaps.items():
        assert gap == pytest.approx(
            mean_huber(np.array([4.0]), DEFAULTS.huber_z) if letter == "E" else 0, abs=1e-9
        )
        assert 0.3 < chance < 0.9


def test_labels_are_said_with_the_words_that_they_need() -> None:
    strata = (("polarity", "ON"), ("intensity", "dark"), ("slope", "rest"))
    assert label_in_words(Label("A", "events", "count", 1.0, strata)) == "events: ON, intensity dark, rest"
    assert label_in_words(Label("C", "lack", "value", 1.0, ())) == "lack"
    said = [label_in_words(label) for label in LABELS]
    assert len(set(said)) == len({(label.name, label.strata) for label in LABELS})
