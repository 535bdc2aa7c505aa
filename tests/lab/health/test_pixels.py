"""Hot and silent pixels."""

from dataclasses import replace

import numpy as np
import pytest
from tests.lab.health.made import START_US, healthy, some_events, well, with_events

from voltcam_lab.health import inspect


def test_hot_pixels_are_found_and_no_others() -> None:
    rng = np.random.default_rng(6)
    where = [(3, 4), (20, 30), (40, 20), (41, 20)]  # at rest, at rest, moving, and beside it
    more = [some_events(START_US + rng.integers(0, 4_000_000, 400), x, y, True) for x, y in where]
    recording = with_events(healthy(), np.concatenate(more))
    hot = inspect(recording).hot
    assert sorted((int(x), int(y)) for y, x in zip(*np.nonzero(hot), strict=True)) == sorted(where)
    assert set(inspect(recording).health["hot pixels"].numbers["xy"]) == set(where)
    assert not well().hot.any()


@pytest.mark.parametrize("seed", range(10, 15))
def test_no_healthy_pixel_is_hot_or_silent(seed: int) -> None:
    """At most one sensor in a hundred has one."""
    health = inspect(healthy(2.0, seed)).health
    assert health["hot pixels"].numbers["xy"] == health["silent pixels"].numbers["xy"] == []


def test_silent_pixels_where_the_light_changed() -> None:
    events = healthy().events
    dead = (events["x"] == 45) & (events["y"] == 20) | (events["x"] == 3) & (events["y"] == 3)
    finding = inspect(replace(healthy(), events=events[~dead])).health["silent pixels"]
    assert finding.numbers["xy"] == [(45, 20)]  # nothing is expected of the one at rest
