"""Whether more is left than light leaves, of gaps and nats that are written down."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import kstest

from voltcam_lab.diagnosis.search.left import by_light, more_than_light
from voltcam_lab.diagnosis.search.settings import DEFAULTS

from ..made_rig import DEAD_TIME
from ..made_steps import step, trial

NAMING = DEFAULTS.naming


def told(nats: float, by_larger_errors: float = 0.0) -> Any:
    return SimpleNamespace(evidence=nats, by_larger_errors=by_larger_errors)


def alone(excess: float, nats: float | None = None) -> float:
    """Where no effect has been found."""
    one = step(excess)
    return by_light(one, one, None if nats is None else told(nats), NAMING)


def test_probabilities_are_uniform_where_light_leaves_what_it_leaves_in_the_mean() -> None:
    """Of either view alone and of both: Kolmogorov and Smirnov's p above .001 for 2000 recordings."""
    rng = np.random.default_rng(11)
    excess = rng.exponential(NAMING.light, 2000)
    nats = rng.exponential(NAMING.light_nats, 2000)
    strips = [alone(one) for one in excess]
    both = [alone(one, other) for one, other in zip(excess, nats, strict=True)]
    assert kstest(strips, "uniform").pvalue > 1e-3
    assert kstest(both, "uniform").pvalue > 1e-3


def test_nats_that_larger_errors_of_the_light_leave_are_no_evidence() -> None:
    """Kolmogorov and Smirnov's p above .001 for 2000 recordings."""
    rng, larger = np.random.default_rng(12), 100.0
    excess = [step(one) for one in rng.exponential(NAMING.light, 2000)]
    nats = rng.exponential(NAMING.light_nats + larger, 2000)
    both = [by_light(e, e, told(one, larger), NAMING) for e, one in zip(excess, nats, strict=True)]
    assert kstest(both, "uniform").pvalue > 1e-3
    none = step(0.0)
    assert more_than_light(none, none, told(200.0), DEFAULTS)
    assert not more_than_light(none, none, told(200.0, larger), DEFAULTS)


@pytest.mark.parametrize(
    ("excess", "times", "more"),
    [
        (0.1, 1.0, False),  # as light leaves in the mean
        (2.7, 1.0, True),  # strips see what is not in all pixels' covariates
        (0.1, 30.0, True),  # all pixels see what strips do not
        (0.3, 3.0, True),  # either alone might be light's
        (0.3, 0.0, False),
        (0.0, 3.0, False),
        (2.7, None, True),  # too few events are judged to tell anything
        (0.1, None, False),
    ],
)
def test_what_one_view_shows_plainly_is_enough_and_so_is_what_both_show(
    excess: float, times: float | None, more: bool
) -> None:
    """times: evidence in units of its mean where nothing is missing."""
    one = step(excess)
    remains = None if times is None else told(times * NAMING.light_nats)
    assert more_than_light(one, one, remains, DEFAULTS) == more


def test_nothing_below_chance_counts() -> None:
    assert alone(-0.3, -0.001) == 1.0


@pytest.mark.parametrize(("before", "more"), [(1.0, True), (40.0, False)])
def test_the_form_of_a_strong_effect_may_leave_more(before: float, more: bool) -> None:
    first, after = step(before, trial(DEAD_TIME, 0.1)), step(0.5, added=DEAD_TIME)
    assert more_than_light(after, first, told(1e4), DEFAULTS) == more  # forms tell all pixels much
