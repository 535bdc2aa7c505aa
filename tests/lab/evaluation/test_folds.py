"""Which parts are fitted and which judged."""

import numpy as np
import pytest

from voltcam_lab.distances import Region
from voltcam_lab.evaluation import folds as module
from voltcam_lab.evaluation.folds import folds, pooled, pooled_region
from voltcam_simulator import EVENT
from voltcam_simulator.effect import Events

WIDTH, HEIGHT, END_US = 96, 72, 1_600_000
WHOLE = Region.whole(WIDTH, HEIGHT, 0, END_US).without(np.array([[100_000, 130_000]]))


def stream(seed: int, n: int = 5000) -> Events:
    rng = np.random.default_rng(seed)
    events = np.zeros(n, EVENT)
    events["t"] = np.sort(rng.integers(0, END_US, n))
    events["x"], events["y"] = rng.integers(0, WIDTH, n), rng.integers(0, HEIGHT, n)
    return events


def test_of_few_events_all_four_quarters_are_judged_each_by_a_fit_that_shares_nothing_with_it() -> None:
    ways = folds(WHOLE, stream(1))
    assert len(ways) == 4
    for fitting, judging in ways:
        assert not (fitting.pixels & judging.pixels).any()
        assert not len(fitting.during(judging.times).times)
        assert fitting.pixel_seconds > 0
    judged = sum(judging.pixel_seconds for _, judging in ways)
    assert judged == pytest.approx(WHOLE.pixel_seconds)
    judged_by = [int(judging.of(stream(1)).size) for _, judging in ways]
    assert sum(judged_by) == WHOLE.of(stream(1)).size


def test_of_many_events_one_quarter_is_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    events = stream(1)
    first = folds(WHOLE, events)[0][1].of(events).size
    for enough, ways in ((first, 1), (first + 1, 4)):
        monkeypatch.setattr(module, "ENOUGH", enough)
        assert len(folds(WHOLE, events)) == ways


def test_events_of_each_way_are_pooled_where_it_judges_in_order_of_time() -> None:
    ways = folds(WHOLE, stream(1))
    parts = [stream(seed) for seed in range(4)]
    for part, number in zip(parts, range(4), strict=True):
        part["p"] = number % 2  # who made it
    found = pooled(parts, ways)
    assert (np.diff(found["t"]) >= 0).all()
    region = pooled_region(WHOLE, ways)
    assert region.pixel_seconds == pytest.approx(WHOLE.pixel_seconds)
    assert region.of(found).size == found.size
    for part, (_, judging) in zip(parts, ways, strict=True):
        assert (
            np.sort(judging.of(found), order=["t", "x", "y"]).tolist()
            == np.sort(judging.of(part), order=["t", "x", "y"]).tolist()
        )


def test_no_interval_goes_from_one_quarter_to_another() -> None:
    ways = folds(WHOLE, stream(1))
    region = pooled_region(WHOLE, ways)
    edges = np.unique(np.concatenate([judging.times.ravel() for _, judging in ways]))
    for edge in edges[1:-1].tolist():
        before, after = region.stretch_of(np.array([edge - 1, edge]))
        assert before != after


def test_of_one_way_there_is_nothing_to_pool() -> None:
    (way, *_), part = folds(WHOLE, stream(1)), stream(2)
    assert pooled([part], [way]) is part
    assert pooled_region(WHOLE, [way]) is way[1]
