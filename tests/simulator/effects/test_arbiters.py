"""Arbiters: what leaves the bus is what a slow twin serves, and each kind has its own order."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from voltcam_simulator import Parameters, Simulator
from voltcam_simulator.random import events_key, uniform

from ..scenes import Events, only, still
from .slow_arbiters import served

HEIGHT, WIDTH = 21, 13
STORM = only(junction_leak={"k4_per_us": 4e-3}, leak_noise={"k6": 5e-2})
BUS = {"row_us": 0.875, "event_us": 0.4375}  # sums of these have no rounding
CHOICES: list[dict[str, Any]] = [
    {"arbiter": "first"},
    {"arbiter": "fair"},
    {"arbiter": "greedy"},
    {"arbiter": "token", "pass_us": 0.25},
    {"arbiter": "token"},
    {"arbiter": "fair", "along": "columns"},
    {"arbiter": "first", "along": "columns"},
    {"arbiter": "first", "crowd": 9, "crowded_arbiter": "token", "pass_us": 0.25},
    {"arbiter": "first", "crowd": 1, "crowded_arbiter": "greedy"},
    {"arbiter": "token", "pass_us": 0.125, "crowd": 12, "crowded_arbiter": "first"},
    {"arbiter": "greedy", "crowd": 10, "crowded_arbiter": "fair"},
    {"arbiter": "first", "start_us": 30.0},
    {"arbiter": "greedy", "start_us": 3.0},
    {"arbiter": "token", "pass_us": 0.25, "start_us": 30.0},
]


def uniforms(seed: int, effect: str) -> Iterator[float]:
    """The random numbers of an effect that has one sequence."""
    state = events_key(seed, effect, 0)
    while True:
        state, number = uniform(np.uint64(state))
        yield float(number)


def seen(parameters: Parameters, steps: int = 200, step_us: int = 10) -> Events:
    """A storm of steps x 10 us, then quiet, so that nothing is left waiting."""
    simulator = Simulator(WIDTH, HEIGHT, parameters, seed=5)
    simulator.advance(still(50, WIDTH, HEIGHT), 0)
    times = [step_us * k for k in range(1, steps + 1)]
    found = [simulator.advance(still(50, WIDTH, HEIGHT), t) for t in times]
    simulator.parameters = parameters.changed({"junction_leak": {"k4_per_us": 0}, "leak_noise": {"k6": 0}})
    found.append(simulator.advance(still(50, WIDTH, HEIGHT), times[-1] + 10_000))
    return np.concatenate(found)


@pytest.mark.parametrize("choice", CHOICES, ids=lambda choice: "-".join(map(str, choice.values())))
def test_the_bus_serves_as_a_slow_twin_does(choice: dict[str, Any]) -> None:
    before = seen(STORM)
    after = seen(STORM.changed({"readout": BUS | choice}))
    wanted = served(before, HEIGHT, WIDTH, **BUS, **choice, uniforms=uniforms(5, "readout"))
    assert len(before) >= len(wanted) > 2000
    assert after.tobytes() == wanted.tobytes()
    groups = np.diff(wanted["t"]) > 0
    assert groups.sum() < 0.8 * len(wanted)  # many share a stamp: the bus is crowded at times


@pytest.mark.parametrize(("steps", "step_us"), [(1000, 2), (40, 50)])
@pytest.mark.parametrize("choice", [CHOICES[3], CHOICES[7]], ids=["token", "crowd"])
def test_it_does_not_matter_how_time_is_cut(choice: dict[str, Any], steps: int, step_us: int) -> None:
    before = seen(STORM, steps, step_us)
    after = seen(STORM.changed({"readout": BUS | choice}), steps, step_us)
    assert after.tobytes() == served(before, HEIGHT, WIDTH, **BUS, **choice).tobytes()


def flash(**readout: Any) -> Events:
    """All pixels at once: 0, 1 or 2 events of each, read by a bus that takes long."""
    parameters = only(contrast_response={"k1": 0.5}).changed(
        {"readout": {"row_us": 5, "event_us": 1} | readout}
    )
    simulator = Simulator(64, 64, parameters, seed=6)
    simulator.advance(still(0, 64, 64), 0)
    return np.concatenate([simulator.advance(still(255, 64, 64), t) for t in (1, 100_000)])


def order(events: Events, along: str = "y") -> np.ndarray:
    """Rows (or columns) in the order in which they leave."""
    numbers = events[along].astype(int)
    return numbers[np.r_[True, np.diff(numbers) != 0]]


def test_a_token_reads_a_flash_from_top_to_bottom() -> None:
    assert (order(flash(arbiter="token")) == np.arange(64)).all()


def test_a_fair_tree_takes_turns_between_the_halves_of_the_sensor() -> None:
    upper = order(flash(arbiter="fair")) >= 32
    assert (upper[::2] != upper[1::2]).all()


def test_a_greedy_tree_ends_a_part_before_it_leaves_it() -> None:
    """Within each aligned block of 2, 4, 8, ... rows all are served in a piece."""
    rows = order(flash(arbiter="greedy"))
    for size in (2, 4, 8, 16, 32):
        assert (np.diff(rows // size) != 0).sum() == 64 // size - 1


def test_columns_leave_in_one_piece_by_rising_y() -> None:
    events = flash(along="columns")
    assert len(order(events, "x")) == 64
    same = np.diff(events["x"].astype(int)) == 0
    assert (np.diff(events["y"].astype(int))[same] > 0).all()
    assert (np.diff(events["t"])[same] == 0).all()


@pytest.mark.parametrize(
    "then", [{"along": "columns"}, {"arbiter": "greedy"}, {"arbiter": "token", "along": "columns"}]
)
def test_a_change_of_arbiter_keeps_what_waits(then: dict[str, Any]) -> None:
    parameters = only(contrast_response={"k1": 0.5}).changed({"readout": {"row_us": 5, "event_us": 1}})
    simulator = Simulator(40, 30, parameters, seed=6)
    simulator.advance(still(0, 40, 30), 0)
    some = [simulator.advance(still(255, 40, 30), t) for t in (1, 60)]
    simulator.parameters = parameters.changed({"readout": then})
    rest = simulator.advance(still(255, 40, 30), 100_000)
    whole = Simulator(40, 30, parameters, seed=6)
    whole.advance(still(0, 40, 30), 0)
    expected = np.concatenate([whole.advance(still(255, 40, 30), t) for t in (1, 60, 100_000)])
    found = np.concatenate([*some, rest])
    assert 0 < sum(map(len, some)) < len(expected) / 2
    assert np.array_equal(*(np.sort(one[["x", "y", "p"]]) for one in (found, expected)))
