"""Items that stand out: by their rate, by their polarity, without an event."""

from typing import Any

import numpy as np

from voltcam_server.dataset.outliers import distances, outliers


def record(name: str, rate: float, on: float = 0.5, events: int = 10_000) -> dict[str, Any]:
    return {
        "name": name, "variant": 0, "events": events, "on": round(on * events), "events_per_s": rate * 100,
        "width": 10, "height": 10,
    }  # fmt: skip


def test_those_far_from_the_others_come_first() -> None:
    rates = np.exp(np.random.default_rng(1).normal(2, 0.3, 200))
    usual = [record(f"usual{i}", rate) for i, rate in enumerate(rates)]
    odd = [record("fast", 400), record("slow", 0.1), record("none", 0, events=0), record("dark", 7, on=0.01)]
    found = outliers([*usual, *odd])
    assert [one.record["name"] for one in found[:3]] == ["none", "slow", "fast"]
    assert [one.why for one in found[:3]] == [
        "it has no event", "few events for this set: 0.1 a second and pixel",
        "many events for this set: 400 a second and pixel",
    ]  # fmt: skip
    assert found[-1].why == "1% of its events are ON"
    # Of a normal law 5e-4 lie beyond 3.5: more than 2 of 200 once in 1000 seeds.
    assert len(found) <= 4 + 2


def test_items_that_are_all_alike_have_none() -> None:
    assert outliers([record(str(i), 5 + 0.01 * (i % 3)) for i in range(20)]) == []
    assert outliers([record("one", 5)]) == []
    assert [one.why for one in outliers([record("one", 0, events=0)])] == ["it has no event"]


def test_a_distance_is_in_standard_deviations_of_the_logarithm() -> None:
    found = distances(np.exp(np.random.default_rng(2).normal(1, 0.5, 100_000)))
    assert abs(np.std(found) - 1) < 0.03  # the robust estimate has 0.4 % of error here
