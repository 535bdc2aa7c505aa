"""How long a bus takes to begin and a row to ask, of rows that ask at random."""

import heapq

import numpy as np
import pytest

from voltcam_lab.health.bus_waits import BusWaits, apart, find_waits
from voltcam_simulator import EVENT, Parameters, Simulator

HEIGHT, WIDTH = 180, 240
PER_US, SECONDS = 0.25, 0.8


@pytest.fixture(scope="module")
def asking() -> np.ndarray:
    """Events at random times, rows and columns."""
    rng = np.random.default_rng(1)
    events = np.zeros(rng.poisson(PER_US * 1e6 * SECONDS), EVENT)
    events["t"] = np.sort(rng.integers(0, int(1e6 * SECONDS), len(events)))
    events["x"], events["y"] = rng.integers(0, WIDTH, len(events)), rng.integers(0, HEIGHT, len(events))
    events["p"] = rng.random(len(events)) < 0.5
    return events


def read(events: np.ndarray, start_us: float, wait_us: float) -> np.ndarray:
    """As a bus of 0.5 us a row reads them, by a code of its own; one event of each reading."""
    rng = np.random.default_rng(2)
    t_us, rows = events["t"].tolist(), events["y"].tolist()
    requests: list[tuple[float, int]] = []  # when rows ask
    waiting, come, free_us = set[int](), 0, 0.0
    out = []
    while come < len(rows) or requests:
        grant_us = max(requests[0][0], free_us) if requests else np.inf
        if come < len(rows) and t_us[come] <= grant_us:
            if rows[come] not in waiting:
                waiting.add(rows[come])
                heapq.heappush(requests, (t_us[come] + rng.exponential(wait_us), rows[come]))
            come += 1
            continue
        asked_us, row = requests[0]
        if asked_us > free_us:  # it was idle
            free_us = asked_us + rng.exponential(start_us)
            continue
        heapq.heappop(requests)
        waiting.remove(row)
        out.append((int(free_us), row))
        free_us += 0.5
    found = np.zeros(len(out), EVENT)
    found["t"], found["y"] = np.array(out).T
    return found


@pytest.mark.parametrize(("start_us", "wait_us"), [(1.3, 4.4), (2.5, 0.0), (0.0, 8.0)])
def test_both_waits_are_found(asking: np.ndarray, start_us: float, wait_us: float) -> None:
    found = find_waits(read(asking, start_us, wait_us), HEIGHT, 0.4, 0.1)
    assert found.start_us == pytest.approx(start_us, rel=0.12)
    assert found.row_us == pytest.approx(wait_us, rel=0.25, abs=0.5)


def test_of_a_bus_that_begins_at_once_no_wait_is_told(asking: np.ndarray) -> None:
    readout = {"readout": {"row_us": 0.4, "event_us": 0.1}}
    for events in (asking, read(asking, 0.0, 0.0)):
        assert find_waits(events, HEIGHT, 0.4, 0.1) == BusWaits()
    simulator = Simulator(WIDTH, HEIGHT, Parameters.of("paper").changed(readout), seed=1)
    rng, found = np.random.default_rng(3), []
    image = rng.uniform(20, 200, (HEIGHT, WIDTH + 60)).astype(np.float32)
    for k in range(60):
        found.append(simulator.advance(image[:, k : k + WIDTH], 20_000 * k))
    assert find_waits(np.concatenate(found), HEIGHT, 0.4, 0.1).start_us == 0


def test_too_few_events_tell_nothing(asking: np.ndarray) -> None:
    assert find_waits(asking[:0], HEIGHT, 0.4, 0.1) == BusWaits()
    assert find_waits(asking[:2000], HEIGHT, 0.4, 0.1) == BusWaits()


def test_the_queue_is_as_it_is_simulated() -> None:
    """Shares of 200 000 readings, each with a standard error of at most 0.0012."""
    rng = np.random.default_rng(4)
    for per_us, service_us, start_us in ((0.1, 0.5, 2.0), (0.3, 0.5, 1.3), (0.5, 0.3, 0.5)):
        free_us, stamps = 0.0, []
        for asked_us in np.cumsum(rng.exponential(1 / per_us, 200_000)).tolist():
            free_us = asked_us + rng.exponential(start_us) if asked_us > free_us else free_us
            stamps.append(int(free_us))
            free_us += service_us
        share = np.mean(np.diff(stamps) >= 2)
        assert apart(np.array([per_us]), np.array([service_us]), start_us)[0] == pytest.approx(
            share, abs=0.006
        )
