"""What firing depends on is found by kind, where and how much; nothing is found where nothing is."""

import numpy as np
import pytest

from voltcam_lab.dependence.covariates import PAST_BINS, Covariate
from voltcam_lab.dependence.told_apart import FEWEST, Telling, told_apart
from voltcam_lab.dependence.words import peak, sentence
from voltcam_lab.pages.dependence import functions

from .made import HEIGHT, echoed, everything, free, look


def test_streams_of_one_kind_are_not_told_apart() -> None:
    """Held out: what chance fits costs there, so that gains are about 0 or below."""
    real = free(1)
    found = told_apart(real, [free(2), free(3)], look(real), everything)
    assert found.total < 1e-3
    assert max(found.alone.values()) < 1e-3
    assert found.events == (12_000, 24_000)


@pytest.mark.parametrize(
    ("other", "name", "kind"), [(False, "own_same", "own past"), (True, "near_same", "neighbours")]
)
def test_an_echo_is_named_by_kind_at_its_time(other: bool, name: str, kind: str) -> None:
    """3 to 10 ms after 30 % of the events: a bin of .15 decades more on either side is within the peak."""
    real = echoed(5, (3000, 10_000), other)
    found = told_apart(real, [free(6)], look(real), everything)
    first = found.steps[0]
    assert (first.covariate.name, first.covariate.kind) == (name, kind)
    assert first.gain > 0.03
    assert first.gain > 2 * sum(step.gain for step in found.steps[1:])
    _, begin, end, ratio = peak(first)
    low, high = (10 ** (0.15 * (edge - 1)) for edge in (begin, end + 1))
    assert 1900 < low < 5000 < high < 17_000
    assert ratio > 1
    words = sentence(first)
    assert "ms after" in words
    assert "times as many" in words
    assert ("a neighbour's event" if other else "the pixel's last event") in words
    assert f"{1000 * first.gain:.1f} millinats" in words


def test_events_that_are_missing_are_a_share_of_those_simulated() -> None:
    found = told_apart(free(6), [echoed(5, (3000, 10_000))], look(free(6)), everything)
    assert "% of the" in sentence(found.steps[0])


def test_the_last_span_has_first_events_too() -> None:
    """They come after no other; a recording may be shorter than that span begins."""
    function, share = np.zeros((2, PAST_BINS)), np.full((2, PAST_BINS), 1 / PAST_BINS)
    own = Covariate("own_same", "own past", "", PAST_BINS)
    for peak_at, never in ((PAST_BINS - 1, True), (PAST_BINS // 2, False)):
        function[:] = np.arange(PAST_BINS) == peak_at
        assert sentence(Telling(own, 0.01, function, share)).endswith("or before there was one.") == never


def test_rows_that_come_together_are_the_bus_s_affair() -> None:
    """A third of the events takes the time of an event of its row, farther to the right."""
    real = free(8)
    rng = np.random.default_rng(9)
    first = real[real["x"] < 10]
    again = first[rng.random(len(first)) < 0.5].copy()
    again["x"] += rng.integers(5, 12, len(again)).astype(np.uint16)
    both = np.concatenate([real, again])
    both = both[np.lexsort((both["x"], both["y"], both["t"]))]
    found = told_apart(both, [free(10)], look(both), everything)
    assert found.steps[0].covariate.name in ("row", "order")
    assert "row" in sentence(found.steps[0])


def test_light_that_moves_is_no_step() -> None:
    """Twice as many events in the lower half: told by row, by no past."""
    real = free(11)
    fewer = free(12)
    fewer = fewer[(fewer["y"] >= HEIGHT // 2) | (np.arange(len(fewer)) % 2 == 0)]
    found = told_apart(fewer, [real], look(real), everything)
    assert found.steps[0].covariate.name == "y"


def test_too_few_events_say_nothing() -> None:
    few = free(1, FEWEST - 1)
    assert np.isnan(told_apart(few, [free(2)], look(few), everything).total)


def test_every_step_has_a_panel_with_its_gain() -> None:
    real = echoed(5, (3000, 10_000))
    found = told_apart(real, [free(6)], look(real), everything)
    axes = functions(found.steps).axes
    assert len(axes) == len(found.steps) > 0
    first = found.steps[0]
    assert axes[0].get_title(loc="left") == f"{1000 * first.gain:.1f} millinats an event"
    assert axes[0].get_xlabel() == first.covariate.title
    assert axes[0].get_ylabel() == "ln (real : simulated)"
