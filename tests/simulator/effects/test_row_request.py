"""A row's request by its signature: exponential waits, and one time for all that come meanwhile."""

from math import log

import numpy as np
import pytest

from voltcam_simulator import Parameters, Simulator
from voltcam_simulator.random import events_key, uniform

from ..scenes import Events, only, watch_still

SIDE, SEED = 24, 4
LEAK = only(junction_leak={"k4_per_us": 1e-7}, threshold_mismatch={"sigma": 0.3})
STORM = only(junction_leak={"k4_per_us": 1e-4}, threshold_mismatch={"sigma": 0.3})


def watched(parameters: Parameters, seconds: float) -> Events:
    return watch_still(Simulator(SIDE, SIDE, parameters, seed=SEED), 50, seconds, 20)


def by_pixel(events: Events) -> Events:
    """The events by pixel, and by time within it."""
    return events[np.lexsort((events["t"], events["x"], events["y"]))]


def test_a_lone_event_waits_exponentially() -> None:
    """Of 6000 waits the mean has a standard error of 1.3 %, a share at most one of 0.0065."""
    wait_us = 200.0
    before, after = (
        by_pixel(watched(p, 100)) for p in (LEAK, LEAK.changed({"row_request": {"wait_us": wait_us}}))
    )
    count = min(len(before), len(after))
    assert count > 5000
    assert np.array_equal(before[["x", "y", "p"]][:count], after[["x", "y", "p"]][:count])
    waits_us = after["t"][:count] - before["t"][:count]
    assert waits_us.min() >= 0
    assert waits_us.mean() == pytest.approx(wait_us, rel=0.06)
    for share in (0.25, 0.5, 0.75):
        assert np.mean(waits_us < -wait_us * log(1 - share)) == pytest.approx(share, abs=0.03)


def test_what_comes_to_a_row_meanwhile_leaves_with_it() -> None:
    """As a slow twin has it, row by row."""
    wait_us = 60.0
    before = watched(STORM, 0.5)
    after = watched(STORM.changed({"row_request": {"wait_us": wait_us}}), 0.5)
    state, asks_us, wanted = events_key(SEED, "row_request", 0), {}, []
    for t, x, y, p in before.tolist():
        if t > asks_us.get(y, -1):
            state, number = uniform(np.uint64(state))
            asks_us[y] = t + int(-wait_us * log(number) + 0.5)
        wanted.append((asks_us[y], x, y, p))
    wanted.sort(key=lambda event: event[0])
    until = [event for event in wanted if event[0] < after["t"][-1]]
    assert len(until) > 2000
    assert [tuple(event) for event in after.tolist()][: len(until)] == until
    same = (np.diff(after["t"]) == 0) & (np.diff(after["y"].astype(int)) == 0)
    joining = wait_us * len(before) / 0.5e6 / SIDE  # events of a row while one waits
    assert same.mean() == pytest.approx(joining / (1 + joining), rel=0.1)
