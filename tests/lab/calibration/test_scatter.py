"""A jitter is found by how wide the scan of the rows is, whatever the delay; without a scan nothing is."""

import numpy as np
import pytest

from voltcam_lab.calibration.camera_frames import filmed
from voltcam_lab.calibration.scatter import as_scattered, scan_variance
from voltcam_lab.light.scene import Scene, scene_of
from voltcam_lab.recordings import Footage
from voltcam_simulator import Parameters

WIDTH, HEIGHT, PERIOD_US, FRAMES = 48, 36, 40_000, 40
SCAN = {
    "aps_coupling": {"frame_period_us": PERIOD_US, "row_us": 60.0, "readout_kick": 0.3, "offset_us": 3000}
}
CAMERA = Parameters.of("ideal").changed(SCAN | {"leak_noise": {"k6": 1e-3}})  # a still scene, noisy pixels


def still() -> Scene:
    """In still light it is noise that brings pixels near a threshold."""
    frames = np.full((FRAMES, HEIGHT, WIDTH), 90, np.uint8)
    return scene_of(frames, np.arange(FRAMES, dtype=np.int64) * PERIOD_US, "linear")


def recorded(jitter_us: float, delay_us: float = 0.0) -> Footage:
    scene = still()
    camera = CAMERA.changed({"latency": {"jitter_us": jitter_us, "delay_us": delay_us}})
    none = np.zeros(0, [("t", "i8")])
    events = filmed(Footage(none, WIDTH, HEIGHT, scene.taken, scene.taken_us), scene, camera, seed=5)
    return Footage(events, WIDTH, HEIGHT, scene.taken, scene.taken_us)


@pytest.mark.parametrize("delay_us", [0.0, 2500.0])
@pytest.mark.parametrize("jitter_us", [8.0, 25.0])
def test_a_jitter_is_found_at_its_size(jitter_us: float, delay_us: float) -> None:
    footage = recorded(jitter_us, delay_us)
    camera = CAMERA.changed({"latency": {"delay_us": delay_us}})
    found, words = as_scattered(footage, filmed(footage, still(), camera, seed=6), camera)
    assert found.latency.jitter_us == pytest.approx(jitter_us, rel=0.15)
    assert found.latency.delay_us == delay_us
    assert words is not None
    assert "jitter" in words


def test_a_scan_as_wide_as_the_simulated_one_leaves_the_camera_as_it_is() -> None:
    footage = recorded(0.0)
    assert as_scattered(footage, filmed(footage, still(), CAMERA, seed=6), CAMERA) == (CAMERA, None)


def test_where_nothing_comes_in_turn_nothing_is_told() -> None:
    footage = recorded(8.0)
    quiet = CAMERA.changed({"aps_coupling": {"readout_kick": 0.0}})
    assert as_scattered(footage, footage.events, quiet) == (quiet, None)
    assert scan_variance(footage.events[:50], footage, CAMERA) is None
