"""How far simulated events are from real ones, as one number."""

import numpy as np
import pytest

from voltcam_lab.distances import FrameLight, Region
from voltcam_lab.distances.goal import SHARED, Goal
from voltcam_lab.light.known import KnownLight
from voltcam_simulator import EVENT

SIDE, END_US = 24, 1_000_000


def stream(seed: int, rate_hz: float = 30.0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    n = rng.poisson(rate_hz * SIDE * SIDE)
    events = np.zeros(n, EVENT)
    events["t"] = np.sort(rng.integers(0, END_US, n))
    events["x"], events["y"] = rng.integers(0, SIDE, (2, n))
    events["p"] = rng.random(n) < 0.5
    return events


@pytest.fixture(scope="module")
def goal() -> Goal:
    """Light that stands still, of many grey levels; half of the pixels are looked at."""
    images = np.repeat(np.random.default_rng(0).integers(20, 200, (1, SIDE, SIDE)), 21, axis=0).astype(
        np.uint8
    )
    light = FrameLight(images, np.linspace(0, END_US, 21).astype(np.int64))
    whole = Region.whole(SIDE, SIDE, 0, END_US)
    return Goal(stream(1), whole.on(np.arange(SIDE) < 12), light)


def test_the_score_of_the_recording_is_nothing(goal: Goal) -> None:
    assert goal.score(goal.real) == 0


def test_what_lies_outside_of_the_region_does_not_count(goal: Goal) -> None:
    assert goal.score(goal.real[goal.real["x"] < 12]) == 0
    more = np.concatenate([goal.real, stream(5)])
    inside = (np.arange(len(more)) < len(goal.real)) | (more["x"] >= 12)
    assert goal.score(np.sort(more[inside], order="t", kind="stable")) == 0


def test_each_thing_that_it_adds_up_raises_it_above_another_draw(goal: Goal) -> None:
    """Rates, intervals, places and polarities; other draws of the same law are near."""
    chance = goal.score(stream(2))
    late = stream(2)
    late["t"] = np.sort(late["t"] // 4)  # as many, in a quarter of the time
    left = stream(2)
    left["x"] //= 2  # as many, but at other places
    on = stream(2)
    on["p"] = True
    for other in (stream(2, 45.0), stream(2, 20.0), late, left, on):
        assert goal.score(other) > 3 * chance


def test_it_grows_with_the_difference_of_rates(goal: Goal) -> None:
    scores = [goal.score(stream(3, rate)) for rate in (30.0, 40.0, 55.0, 80.0)]
    assert (np.diff(scores) > 0).all()


def test_events_that_share_their_time_with_a_neighbour_count_much(goal: Goal) -> None:
    """Half of all have that of the pixel beside them; by chance a few in a thousand have."""
    first = stream(4, 15.0)
    beside = first.copy()
    beside["x"] ^= 1
    apart = beside.copy()
    apart["t"] = np.minimum(apart["t"] + 500, END_US - 1)
    pairs, none = (np.sort(np.concatenate([first, more]), order="t") for more in (beside, apart))
    assert goal.score(pairs) - goal.score(none) > 0.35 * SHARED


def test_events_in_light_that_is_not_known_do_not_count(goal: Goal) -> None:
    """From .4 to .5 s nothing is known: whatever comes there, the score is the recording's. Only how many
    have their time in common tells in any light; here none have."""
    frames_us = np.linspace(0, END_US, 21).astype(np.int64)
    known = KnownLight.everywhere(frames_us, SIDE, SIDE)
    known.gaps[8:10] = False
    real = goal.real[np.unique(goal.real["t"], return_index=True)[1]]
    some = Goal(real, goal.region, goal.light, known)
    there = (real["t"] >= frames_us[8]) & (real["t"] < frames_us[10])
    assert some.score(real[~there]) == 0 < goal.score(real[~there])
    beside = real[there]
    beside["x"] ^= 1
    assert some.score(np.sort(np.concatenate([real, beside]), order="t")) > 0.05 * SHARED


def test_an_event_that_light_before_may_have_made_does_not_count(goal: Goal) -> None:
    """Up to .5 s nothing is known, and each pixel has one event in the .45 s behind. Without it, or with
    another, the score is the recording's; a second one tells."""
    frames_us = np.linspace(0, END_US, 21).astype(np.int64)
    known = KnownLight.everywhere(frames_us, SIDE, SIDE)
    known.gaps[:10] = False
    first = np.zeros(SIDE * SIDE, EVENT)
    first["y"], first["x"] = np.divmod(np.arange(SIDE * SIDE), SIDE)
    first["t"] = 500_000 + 700 * np.arange(SIDE * SIDE)
    some = Goal(first, goal.region, goal.light, known)
    other, twice = first.copy(), np.repeat(first, 2)
    other["p"] = True
    twice["t"][1::2] += 300
    assert some.score(first[:0]) == some.score(other) == 0 < some.score(twice)
