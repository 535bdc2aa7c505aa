"""What the camera's frames do to its events: kicks are found at their size, and none where there are none."""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_lab.calibration.camera_frames import PhaseGoal, with_frames_of
from voltcam_lab.health import inspect
from voltcam_lab.light.scene import Scene, scene_of
from voltcam_lab.models.model import MODELS, simulate
from voltcam_lab.recordings import Footage
from voltcam_simulator import Parameters

from ..health.made import HEIGHT, PERIOD_US, WIDTH, healthy, well

CAMERA = Parameters.of("ideal").changed({"contrast_response": {"k1": 4.0}, "leak_noise": {"k6": 3e-4}})
EXPOSURE_US = 1500.0


def filmed(**kicks: float) -> tuple[Footage, Scene]:
    """A camera of ours whose frames do this; exposures begin with the frames' stamps."""
    given = healthy()
    scene = scene_of(given.frames, given.frame_t_us, "cubic")
    times = {
        "frame_period_us": PERIOD_US, "exposure_us": EXPOSURE_US, "row_us": 0.01,
        "offset_us": float(given.frame_t_us[0] % PERIOD_US),
    }  # fmt: skip
    camera = CAMERA.changed({"aps_coupling": {**times, **kicks}})
    events = simulate(MODELS["exact"](WIDTH, HEIGHT, camera, 3), scene)
    return Footage(events, WIDTH, HEIGHT, given.frames, given.frame_t_us), scene


@pytest.mark.parametrize("size", [0.1, -0.1])
def test_a_kick_of_the_exposure_is_found_at_its_size(size: float) -> None:
    footage, scene = filmed(exposure_kick=size)
    found, words = with_frames_of(inspect(footage), scene, footage, CAMERA, seed=8)
    kick = found.aps_coupling
    assert kick.exposure_kick == pytest.approx(size, rel=0.35)
    assert (kick.reset_kick, kick.readout_kick) == (0, 0)
    assert kick.frame_period_us == PERIOD_US
    assert words is not None
    assert "exposure_kick" in words


def test_an_exposure_is_moved_to_where_its_events_are() -> None:
    """The file tells of exposures 90 us after the pixels saw them."""
    footage, scene = filmed(exposure_kick=0.1)
    begin_us = footage.frame_t_us + 90
    told = replace(footage, exposure_us=np.stack([begin_us, begin_us + int(EXPOSURE_US)], axis=1))
    kick = with_frames_of(inspect(told), scene, told, CAMERA, seed=8)[0].aps_coupling
    late_us = (kick.offset_us + HEIGHT * kick.row_us - float(footage.frame_t_us[0])) % PERIOD_US
    assert min(late_us, PERIOD_US - late_us) <= 30
    assert kick.exposure_us == EXPOSURE_US


def test_stamps_may_be_those_of_a_clock_that_began_in_1970() -> None:
    """A period that is no whole number of microseconds must not add up to another phase."""
    given, (footage, _) = healthy(), filmed(exposure_kick=0.1)
    late_us, events = 1_589_163_147_365_215, footage.events.copy()
    events["t"] += late_us
    frame_t_us = given.frame_t_us + late_us
    frame_t_us[-1] += 1
    later = Footage(events, WIDTH, HEIGHT, given.frames, frame_t_us)
    scene = scene_of(given.frames, frame_t_us, "cubic")
    kick = with_frames_of(inspect(later), scene, later, CAMERA, seed=8)[0].aps_coupling
    assert kick.exposure_kick == pytest.approx(0.1, rel=0.35)
    period_ns = round(kick.frame_period_us * 1000)
    assert period_ns % 1000 != 0
    exposed_ns = round((kick.offset_us + HEIGHT * kick.row_us) * 1000)
    behind_us = (1000 * int(frame_t_us[0]) - exposed_ns) % period_ns / 1000
    assert min(behind_us, PERIOD_US - behind_us) < 300


def test_events_that_do_not_come_with_frames_leave_the_camera_as_it_is() -> None:
    inspection = well()
    footage = inspection.footage
    scene = scene_of(footage.frames, footage.frame_t_us, "linear")
    assert with_frames_of(inspection, scene, footage, CAMERA, seed=8) == (CAMERA, None)


def test_the_goal_is_next_to_nothing_for_another_run_of_the_camera() -> None:
    footage, scene = filmed(exposure_kick=0.1)
    goal = PhaseGoal.of(footage)
    plain, _ = filmed()
    times = {"frame_period_us": PERIOD_US, "exposure_us": EXPOSURE_US, "row_us": 0.01, "exposure_kick": 0.1}
    offset = {"offset_us": float(footage.frame_t_us[0] % PERIOD_US)}
    again = CAMERA.changed({"aps_coupling": times | offset})
    other = simulate(MODELS["exact"](WIDTH, HEIGHT, again, 5), scene)
    assert goal.excess(footage.events) < 0  # what chance makes is taken off
    assert abs(goal.excess(other)) < 0.2 * goal.excess(plain.events)
    assert np.isfinite(goal.excess(other[:0]))
