"""The arbiter by its signature: shared stamps in a row, a floor of intervals, a cap on bursts."""

import numpy as np
import pytest

from voltcam_simulator import Parameters, Simulator

from ..scenes import Events, only, still, watch_still

SIDE = 64
ONCE = only(contrast_response={"k1": 0.5})  # a step of 0 to 255 DN gives 0, 1 or 2 events


def step(parameters: Parameters, spans_us: list[int]) -> Events:
    """Dark to bright within 1 us, and then bright for each of the spans."""
    simulator = Simulator(SIDE, SIDE, parameters, seed=6)
    simulator.advance(still(0, SIDE, SIDE), 1_000_000)
    times = 1_000_001 + np.cumsum([0, *spans_us])
    return np.concatenate([simulator.advance(still(255, SIDE, SIDE), int(t)) for t in times])


@pytest.mark.parametrize("spans_us", [[100_000], [7] * 30 + [100_000]])
def test_a_flash_leaves_row_by_row_at_the_speed_of_the_bus(spans_us: list[int]) -> None:
    row_us, event_us = 2.3, 0.71
    events = step(ONCE.changed({"readout": {"row_us": row_us, "event_us": event_us}}), spans_us)
    base = step(ONCE, spans_us)
    address, wanted = (np.unique(e["y"].astype(int) * SIDE + e["x"]) for e in (events, base))
    assert (address == wanted).all()
    assert len(events) == len(wanted) < len(base)  # one event waits in a pixel; a second is lost
    rows, first, sizes = np.unique(events["y"], return_index=True, return_counts=True)
    order = np.argsort(first)
    assert (first[order] == np.r_[0, np.cumsum(sizes[order])[:-1]]).all()  # each row in one piece
    granted = np.r_[0, np.cumsum(row_us + event_us * sizes[order])[:-1]]
    assert len(rows) == SIDE
    expected = np.repeat(1_000_000 + np.floor(granted + 1e-9).astype(int), sizes[order])
    assert (events["t"] == expected).all()
    inside = np.diff(events["y"].astype(int)) == 0
    assert (np.diff(events["x"].astype(int))[inside] > 0).all()


def test_a_quiet_sensor_does_not_notice() -> None:
    leak = only(junction_leak={"k4_per_us": 1e-7})
    shared = leak.changed({"readout": {"row_us": 0.29, "event_us": 0.083}})
    before, after = (watch_still(Simulator(20, 20, p, seed=1), 0, 20, 7) for p in (leak, shared))
    assert len(before) > 500
    assert before.tobytes() == after.tobytes()


def test_a_storm_is_capped_and_grouped() -> None:
    """4 million events a second, 64 x 64 pixels at 1 kHz, to a bus of 1 us a row and 0.5 us an event."""
    storm = only(junction_leak={"k4_per_us": 1e-3})
    bus = storm.changed({"readout": {"row_us": 1.0, "event_us": 0.5}})
    before, after = (watch_still(Simulator(SIDE, SIDE, p, seed=1), 0, 0.2, 240) for p in (storm, bus))
    assert len(before) / 0.2 == pytest.approx(4.1e6, rel=0.05)
    groups = 1 + (np.diff(after["t"]) + np.abs(np.diff(after["y"].astype(int))) > 0).sum()
    busy_us = groups * 1.0 + len(after) * 0.5
    assert busy_us == pytest.approx(200_000, rel=0.01)  # never idle, never faster
    assert len(after) / groups > 5
    windows = np.bincount(after["t"] // 1000)
    assert windows.max() <= 1000 / 0.5
    in_row = [((np.diff(e["t"]) == 0) & (np.diff(e["y"].astype(int)) == 0)).mean() for e in (before, after)]
    assert in_row[0] < 0.03
    assert in_row[1] > 0.8
    # rows are served in the order of asking: none starves
    assert np.bincount(after["y"], minlength=SIDE).min() > 0.9 * len(after) / SIDE
