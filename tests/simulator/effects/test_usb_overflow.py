"""USB overflow by its signature: holes of the whole array above a rate."""

import numpy as np
import pytest

from voltcam_simulator import Simulator

from ..scenes import Events, only, watch_still

STORM = only(junction_leak={"k4_per_us": 1e-4})  # 100 x 100 pixels at 100 Hz: 1 million events/s
SECONDS = 1


def storm(fps: float, **usb: float) -> Events:
    parameters = STORM.changed({"usb_overflow": usb})
    return watch_still(Simulator(100, 100, parameters, seed=3), 0, SECONDS, fps)


@pytest.mark.parametrize("fps", [9, 700])
def test_above_its_rate_the_camera_goes_blind_in_turns(fps: float) -> None:
    """A buffer of 2000 fills at 1 - 0.5 million events/s in 4 ms, and is empty again 4 ms later."""
    events = storm(fps, max_rate_events_per_s=5e5, buffer_events=2000)
    silence = np.diff(events["t"])
    holes = silence[silence > 1000]
    assert len(holes) == pytest.approx(SECONDS / 8e-3, rel=0.05)
    assert holes.mean() == pytest.approx(4000, rel=0.02)
    assert np.delete(silence, np.flatnonzero(silence > 1000)).max() < 100
    assert len(events) == pytest.approx(5e5 * SECONDS, rel=0.02)


def test_what_passes_is_unchanged_and_below_its_rate_all_passes() -> None:
    before = storm(60)
    assert storm(60, max_rate_events_per_s=2e6, buffer_events=500).tobytes() == before.tobytes()
    after = storm(60, max_rate_events_per_s=5e5, buffer_events=2000)
    assert np.isin(after, before).all()
