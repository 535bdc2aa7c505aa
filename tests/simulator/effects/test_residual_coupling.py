"""A kick after a neighbour's event, by its signature: neighbours fire some time after each other."""

import math

import numpy as np
import pytest

from voltcam_simulator import Simulator

from ..scenes import Events, only, watch_still

SIDE, SECONDS = 200, 0.5
LEAK = {"k4_per_us": 1e-6}


def at_rest(side: int = SIDE, fps: float = 50, **changes: object) -> Events:
    parameters = only(junction_leak=LEAK, **changes)
    return watch_still(Simulator(side, side, parameters, seed=8), 100, SECONDS, fps)


def pairs(events: Events, delay_us: int) -> int:
    """Pairs of events of direct neighbours, so long after each other."""
    when = {(t, x, y) for t, x, y, _ in events.tolist()}
    steps = ((-1, 0), (1, 0), (0, -1), (0, 1))
    return sum((t + delay_us, x + dx, y + dy) in when for t, x, y in when for dx, dy in steps)


@pytest.mark.parametrize("fps", [20, 500])
@pytest.mark.parametrize("chance", [0.5, 1.0])
def test_neighbours_within_reach_fire_after_the_delay(chance: float, fps: float) -> None:
    size, delay_us = 0.03, 700
    kick = {"after_on": size, "chance": chance, "delay_us": delay_us}
    events = at_rest(fps=fps, residual_coupling=kick)
    # voltages are uniform on (0, 1), so each of four neighbours is within reach with chance `size`; what is
    # set off does not kick, and all voltages rise by the kicks
    neighbours = 4 * (1 - 1 / SIDE) * chance * size
    expected = neighbours / (1 + neighbours)
    share = pairs(events, delay_us) / len(events)
    assert share == pytest.approx(expected, abs=5 * math.sqrt(expected / len(events)) + 2 * expected * size)


def test_without_it_they_do_so_by_chance_only() -> None:
    assert pairs(at_rest(), 700) < 10  # expected 1: 20 000 events, 80 000 neighbours, 0.5 s in microseconds


def test_corner_and_single_pixels_have_no_more_neighbours_than_they_have() -> None:
    for width, height in ((1, 1), (1, 7), (7, 1), (2, 2)):
        parameters = only(junction_leak={"k4_per_us": 1e-4}, residual_coupling={"after_on": 3.0})
        events = watch_still(Simulator(width, height, parameters, seed=1), 100, 1, 10)
        assert len(events) >= 99 * width * height
        assert events["x"].max() < width
        assert events["y"].max() < height
        at_once = np.bincount(np.unique(events["t"], return_inverse=True)[1]).max()
        assert at_once <= width * height


def test_a_pixel_that_dies_with_an_event_on_the_way_keeps_a_voltage() -> None:
    """It is a pixel again when it is brought back to life."""
    alive = only(
        junction_leak={"k4_per_us": 1e-5},
        noise_pairs={"rate_hz": 100, "half_dn": 1e5, "interval_us": 20_000},
        residual_coupling={"after_on": 0.3, "after_off": -0.3, "delay_us": 3000},
    )  # fmt: skip
    simulator = Simulator(40, 40, alive, seed=3)
    for k in range(4):
        simulator.parameters = alive.changed({"dead_pixels": {"fraction": 0.5 * (k == 2)}})
        simulator.advance(np.full((40, 40), 100, np.float32), k * 20_000)
        assert np.isfinite(simulator.snapshot()["voltage"]).all()
