"""Times of a row and of an event, from stretches in which the bus is never idle."""

import numpy as np
import pytest

from voltcam_lab.health.bus import find_bus
from voltcam_simulator import EVENT, Parameters, Simulator


def storm(row_us: float, event_us: float) -> np.ndarray:
    """Flashes of different strength, which the bus reads row by row; and few events between."""
    bus = {"readout": {"row_us": row_us, "event_us": event_us}, "contrast_response": {"k1": 2.0}}
    simulator = Simulator(160, 90, Parameters.of("ideal").changed(bus), seed=1)
    rng, found = np.random.default_rng(2), [np.empty(0, EVENT)]
    former = np.full((90, 160), 90, np.float32)
    for k in range(60):
        lit = rng.random((90, 160)) < rng.uniform(0.02, 0.12)
        image = np.where(lit, 60 + 150 * (k % 2), 90).astype(np.float32)
        found += [simulator.advance(former, 20_000 * k), simulator.advance(image, 20_000 * k + 1)]
        former = image
    return np.concatenate(found)


@pytest.mark.parametrize(("row_us", "event_us"), [(0.28, 0.11), (1.0, 0.05)])
def test_the_times_of_the_bus_are_found(row_us: float, event_us: float) -> None:
    """Another code's queue of rows would be better; the simulator's has closed forms of its own tests."""
    found = find_bus(storm(row_us, event_us))
    assert found is not None
    assert found.row_us == pytest.approx(row_us, rel=0.25)
    assert found.event_us == pytest.approx(event_us, rel=0.25)


def test_a_bus_that_is_idle_tells_nothing() -> None:
    rng = np.random.default_rng(3)
    events = np.zeros(30_000, EVENT)
    events["t"] = np.sort(rng.integers(0, 1_000_000, 30_000))
    assert find_bus(events) is None
    assert find_bus(events[:0]) is None
