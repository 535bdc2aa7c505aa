"""What the bus of a recording becomes in the camera's file, and in words."""

from types import SimpleNamespace
from typing import Any

import pytest

from voltcam_lab.calibration.bus import as_read
from voltcam_lab.health.bus import Bus
from voltcam_lab.health.bus_waits import BusWaits
from voltcam_simulator import Parameters


@pytest.mark.parametrize("waits", [BusWaits(1.3, 4.4), BusWaits(0.0, 4.4), BusWaits()])
def test_times_and_waits_are_in_the_file_and_waits_are_told_where_there_are_any(waits: BusWaits) -> None:
    seen: Any = SimpleNamespace(bus=Bus(0.38, 0.1, 0.0, "rows", "greedy", 27, waits), token_scan=None)
    former = Parameters().changed({"readout": {"start_us": 9.0}, "row_request": {"wait_us": 9.0}})
    found, notes = as_read(seen, former)
    readout = found.readout
    assert (readout.row_us, readout.event_us, readout.start_us) == (0.38, 0.1, waits.start_us)
    assert (readout.along, readout.arbiter) == ("rows", "greedy")
    assert found.row_request.wait_us == waits.row_us
    assert any("begins after" in note for note in notes) == (waits != BusWaits())


def test_what_no_recording_tells_stays() -> None:
    seen: Any = SimpleNamespace(bus=None, token_scan=None)
    former = Parameters().changed({"readout": {"row_us": 0.3}, "row_request": {"wait_us": 9.0}})
    assert as_read(seen, former) == (former, [])
