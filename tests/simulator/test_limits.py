"""Bounds of the work on one interval."""

import math

import pytest

from voltcam_simulator.limits import GivenUpError, Limits, TooLongError, TooManyEventsError


def test_as_many_events_as_may_be_are_admitted_and_no_more() -> None:
    limits = Limits(most_events=10)
    limits.admit(10)
    with pytest.raises(TooManyEventsError):
        limits.admit(11)


def test_it_is_given_up_once_it_is_late() -> None:
    answers = iter([False, True])
    limits = Limits(late=lambda: next(answers))
    limits.hurry()
    with pytest.raises(TooLongError):
        limits.hurry()


def test_both_are_ways_of_giving_up() -> None:
    assert issubclass(TooLongError, GivenUpError)
    assert issubclass(TooManyEventsError, GivenUpError)


@pytest.mark.parametrize("coarser", [0.5, 0.0, -1.0, math.inf, math.nan])
def test_steps_are_not_made_finer_nor_endless(coarser: float) -> None:
    with pytest.raises(ValueError, match="give 1 or more"):
        Limits(coarser=coarser)
