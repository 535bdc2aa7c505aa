"""Times of a bus and its arbiter, from stretches in which it is never idle."""

from typing import Any

import numpy as np
import pytest

from voltcam_lab.health.bus import find_bus
from voltcam_simulator import EVENT, Parameters, Simulator

HEIGHT, WIDTH = 90, 160


def storm(
    row_us: float, event_us: float, most_lit: float = 0.12, rise_us: int = 20, **choice: Any
) -> np.ndarray:
    """Flashes of different strength within rise_us, which the bus reads row by row; few events between."""
    readout = {"row_us": row_us, "event_us": event_us, **choice}
    bus = {"readout": readout, "contrast_response": {"k1": 2.0}}
    simulator = Simulator(WIDTH, HEIGHT, Parameters.of("ideal").changed(bus), seed=1)
    rng, found = np.random.default_rng(2), [np.empty(0, EVENT)]
    former = np.full((90, 160), 90, np.float32)
    for k in range(60):
        lit = rng.random((90, 160)) < rng.uniform(most_lit / 6, most_lit)
        bright = rng.uniform(150, 250, lit.shape) if k % 2 else rng.uniform(20, 50, lit.shape)
        image = np.where(lit, bright, 90).astype(np.float32)
        found += [simulator.advance(former, 20_000 * k), simulator.advance(image, 20_000 * k + rise_us)]
        former = image
    return np.concatenate(found)


@pytest.mark.parametrize(("row_us", "event_us"), [(0.28, 0.11), (1.0, 0.05)])
def test_the_times_of_the_bus_are_found(row_us: float, event_us: float) -> None:
    """Another code's queue of rows would be better; the simulator's has closed forms of its own tests."""
    found = find_bus(storm(row_us, event_us), HEIGHT, WIDTH)
    assert found is not None
    assert found.row_us == pytest.approx(row_us, rel=0.25)
    assert found.event_us == pytest.approx(event_us, rel=0.25)


@pytest.mark.parametrize("along", ["rows", "columns"])
@pytest.mark.parametrize("arbiter", ["first", "fair", "greedy", "token"])
def test_the_arbiter_is_told_by_the_order_in_which_rows_leave(along: str, arbiter: str) -> None:
    """So few ask in the same microsecond that their order is not that of the simulator's stamps."""
    found = find_bus(storm(0.8, 0.1, 0.03, 60, along=along, arbiter=arbiter), HEIGHT, WIDTH)
    assert found is not None
    assert (found.along, found.arbiter) == (along, arbiter)


def test_the_way_of_a_token_is_timed() -> None:
    found = find_bus(storm(0.3, 0.05, arbiter="token", pass_us=0.2), HEIGHT, WIDTH)
    assert found is not None
    assert found.pass_us == pytest.approx(0.2, rel=0.25)


def test_a_bus_that_is_idle_tells_nothing() -> None:
    rng = np.random.default_rng(3)
    events = np.zeros(30_000, EVENT)
    events["t"] = np.sort(rng.integers(0, 1_000_000, 30_000))
    assert find_bus(events, HEIGHT, WIDTH) is None
    assert find_bus(events[:0], HEIGHT, WIDTH) is None
