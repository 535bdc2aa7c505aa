"""Frames of all kinds into intervals of events."""

from dataclasses import replace

import numpy as np
import pytest
from pydantic import ValidationError

from voltcam_server.camera_settings import Upsample
from voltcam_server.camera_time import PATIENCE_FRAMES
from voltcam_server.overload import OverloadSettings
from voltcam_server.simulation import Simulation
from voltcam_simulator import Limits, Parameters, Simulator
from voltcam_video import Frame, between

from .rig import arrival, moving_frames, tiny

HOUR_US = 3_600_000_000
SILENT = {
    "contrast_response": {"k1": 0},
    "photon_noise": {"k3": 0},
    "junction_leak": {"k4_per_us": 0},
    "parasitic_photocurrent": {"k5_per_dn_us": 0},
    "leak_noise": {"k6": 0},
}


def test_intervals_are_the_simulators() -> None:
    camera = tiny()
    simulation, simulator = Simulation(camera, "exact", 5), Simulator(24, 16, camera.parameters, seed=5)
    for i, image in enumerate(moving_frames(10, camera)):
        interval = simulation.step(arrival(image, 1000 * i))
        assert interval is not None
        np.testing.assert_array_equal(interval.events, simulator.advance(image, 1000 * i))
        assert (interval.start_us, interval.end_us) == (max(0, 1000 * (i - 1)), 1000 * i)
        assert interval.frame_us == 1000 * i
        np.testing.assert_array_equal(interval.image_u8, image)


def test_the_pixels_see_the_light_of_a_video_and_a_change_of_source_is_followed() -> None:
    """What they see is what a simulator sees whose camera undoes the code by itself."""
    camera = tiny()
    simulation = Simulation(camera, "exact", 5)
    coded = camera.parameters.changed({"input_response": {"gamma_exponent": 2.2}})
    simulator = Simulator(24, 16, camera.parameters, seed=5)
    for i, image in enumerate(moving_frames(12, camera)):
        gamma = 2.2 if 4 <= i < 8 else 1.0
        if i in (4, 8):
            simulator.parameters = coded if i == 4 else camera.parameters
        came = arrival(image, 1000 * i)
        interval = simulation.step(replace(came, frame=replace(came.frame, gamma=gamma)))
        assert interval is not None
        np.testing.assert_array_equal(interval.events, simulator.advance(image, 1000 * i))
        assert (interval.gamma, interval.parameters_version) == (gamma, 0)
        assert simulation.parameters == (camera.parameters, 0)


@pytest.mark.parametrize(
    ("upsample", "later"), [("off", 0), ("linear", 0), ("cubic", 1), ("auto", 0), (3, 0)]
)
def test_frames_in_between_are_those_of_an_offline_run(upsample: Upsample, later: int) -> None:
    """Live as offline; on the cubic a frame later, when the curve beyond it is known."""
    camera = tiny().model_copy(update={"width": 64, "height": 48})
    y, x = np.mgrid[0:48, 0:64]
    images = [(120 + 90 * np.sin(0.3 * (x - 3 * i)) * np.cos(0.2 * y)).astype(np.uint8) for i in range(8)]
    frames = [Frame(image, 10_000 * i) for i, image in enumerate(images)]
    simulator = Simulator(64, 48, camera.parameters, seed=5)
    how = "linear" if upsample == "off" else upsample
    expected: list[np.ndarray] = []
    parts: list[np.ndarray] = []
    for frame in between(frames, how):
        parts.append(simulator.advance(frame.image, frame.t_us))
        if any(frame is real for real in frames):
            expected.append(np.concatenate(parts))
            parts = []

    simulation = Simulation(camera, "exact", 5, upsample)
    intervals = [simulation.step(arrival(image, 10_000 * i)) for i, image in enumerate(images)]
    assert [interval is None for interval in intervals] == [True] * later + [False] * (8 - later)
    found = [interval.events for interval in intervals[later + 1 :] if interval is not None]
    for ours, theirs in zip(found, expected[1:], strict=False):
        np.testing.assert_array_equal(ours, theirs)
    assert len(found) == 7 - later
    assert sum(map(len, found)) > 5000


def test_an_interval_with_a_dropped_frame_has_the_steps_of_one_without() -> None:
    """A lamp asks for 16 steps in a period; where a frame was dropped it gets 8."""
    flicker = Parameters().changed(
        {"contrast_response": {"k1": 60}, "flicker": {"frequency_hz": 100, "depth": 0.2}}
    )
    camera = tiny().model_copy(update={"parameters": flicker})
    image, seen = np.full((16, 24), 100, np.uint8), []
    for missed in (0, 1):
        simulation, simulator = Simulation(camera, "exact", 0), Simulator(24, 16, camera.parameters)
        simulation.step(arrival(image, 0))
        simulator.advance(image, 0)
        interval = simulation.step(arrival(image, 20_000, missed=missed))
        assert interval is not None
        np.testing.assert_array_equal(interval.events, simulator.advance(image, 20_000, Limits(1 + missed)))
        seen.append(interval.events)
    assert not np.array_equal(*seen)


def test_stamps_that_repeat_or_go_back_are_skipped_and_counted() -> None:
    camera = tiny()
    images = moving_frames(5, camera)
    simulation = Simulation(camera, "exact", 0)
    stamps = [0, 1000, 1000, 400, 2000]
    intervals = [simulation.step(arrival(image, t)) for image, t in zip(images, stamps, strict=True)]
    assert [interval is None for interval in intervals] == [False, False, True, True, False]
    assert (simulation.simulated, simulation.out_of_order) == (3, 2)
    last = intervals[-1]
    assert last is not None
    assert (last.start_us, last.end_us) == (1000, 2000)


def test_a_clock_that_was_set_back_is_followed_after_a_while() -> None:
    camera = tiny()
    image = moving_frames(1, camera)[0]
    simulation = Simulation(camera, "exact", 0)
    simulation.step(arrival(image, HOUR_US))
    simulation.step(arrival(image, HOUR_US + 1000))
    later = [simulation.step(arrival(image, 1000 * i)) for i in range(PATIENCE_FRAMES + 3)]
    assert [interval is None for interval in later] == [True] * PATIENCE_FRAMES + [False] * 3
    ends = [interval.end_us - HOUR_US for interval in later if interval]
    assert ends == [2000, 3000, 4000]
    assert simulation.out_of_order == PATIENCE_FRAMES


def test_a_cut_gives_no_events_and_time_runs_on() -> None:
    camera = tiny()
    black, white = np.full((2, 16, 24), [[[0]], [[255]]], np.uint8)
    simulation = Simulation(camera, "exact", 0)
    simulation.step(arrival(black, 5000))
    simulation.step(arrival(black, 7000))
    cut = simulation.step(arrival(white, 10, cut=True))
    after = simulation.step(arrival(white, 1010))
    assert cut is not None
    assert after is not None
    assert cut.events.size == 0
    assert (cut.start_us, cut.end_us, after.end_us) == (9000, 9000, 10000)
    ahead = simulation.step(arrival(black, HOUR_US, cut=True))
    assert ahead is not None
    assert ahead.end_us == HOUR_US  # a time that is later is taken as it is


def test_two_days_between_two_frames_are_a_cut() -> None:
    camera = tiny()
    simulation = Simulation(camera, "exact", 0)
    simulation.step(arrival(np.zeros((16, 24), np.uint8), 0))
    interval = simulation.step(arrival(np.full((16, 24), 255, np.uint8), 48 * HOUR_US))
    assert interval is not None
    assert (interval.events.size, interval.start_us, interval.end_us) == (0, 48 * HOUR_US, 48 * HOUR_US)


@pytest.mark.parametrize("value", [np.nan, -1.0])
def test_grey_levels_that_are_none_are_skipped_and_counted(value: float) -> None:
    simulation = Simulation(tiny(), "exact", 0)
    good, bad = np.full((16, 24), 9, np.float32), np.full((16, 24), value, np.float32)
    assert [simulation.step(arrival(x, t)) is None for x, t in ((good, 0), (bad, 1000), (good, 2000))] == [
        False,
        True,
        False,
    ]
    assert (simulation.simulated, simulation.unusable) == (2, 1)
    assert "not finite" in simulation.fault


@pytest.mark.parametrize("size", [(16, 24), (480, 640), (100, 30), (7, 5)])
def test_a_frame_size_may_change_at_any_time(size: tuple[int, int]) -> None:
    simulation = Simulation(tiny(), "exact", 0)
    for t_us, shape in ((0, (16, 24)), (1000, size), (2000, (16, 24))):
        interval = simulation.step(arrival(np.zeros(shape, np.uint8), t_us))
        assert interval is not None
        assert interval.image.shape == (16, 24)


@pytest.mark.parametrize(
    ("start_us", "period_us"), [(1_700_000_000_000_000, 10_000), (36_000_000_000, 10_000)]
)
def test_the_start_of_time_changes_no_event(start_us: int, period_us: int) -> None:
    """An epoch-sized start, and ten hours: float32 or int32 microseconds would lose events."""
    camera = tiny()
    runs = []
    for start in (0, start_us):
        simulation = Simulation(camera, "exact", 3)
        steps = [
            simulation.step(arrival(image, start + 10_000 * i))
            for i, image in enumerate(moving_frames(20, camera))
        ]
        events = np.concatenate([step.events for step in steps if step])
        events["t"] -= start
        runs.append(events)
    assert runs[0].size > 1000
    np.testing.assert_array_equal(runs[0], runs[1])


def test_ten_hours_of_sparse_frames_leak_as_many_events_at_any_start() -> None:
    camera = tiny(junction_leak={"k4_per_us": 1e-7}, parasitic_photocurrent={"k5_per_dn_us": 0})
    counts = []
    for start in (0, 1_700_000_000_000_000):
        simulation = Simulation(camera, "exact", 3, overload=OverloadSettings(longest_interval_us=HOUR_US))
        grey = np.full((16, 24), 100, np.uint8)
        steps = [simulation.step(arrival(grey, start + 900_000_000 * i)) for i in range(41)]
        counts.append(sum(step.events.size for step in steps if step))
    assert counts[0] == counts[1]
    assert counts[0] == pytest.approx(24 * 16 * 3600, rel=0.01)  # one in 10 s from each pixel


def test_a_change_holds_from_the_next_interval_on_and_says_so() -> None:
    camera = tiny()
    images = moving_frames(6, camera)
    simulation = Simulation(camera, "exact", 0)
    intervals = []
    for i, image in enumerate(images):
        if i == 3:
            assert simulation.change(SILENT)[1] == 1
        intervals.append(simulation.step(arrival(image, 10_000 * i)))
    assert [(step.parameters_version, step.events.size > 0) for step in intervals if step] == [
        (0, False),  # the first frame ends no interval
        (0, True),
        (0, True),
        (1, False),
        (1, False),
        (1, False),
    ]


def test_an_impossible_change_changes_nothing() -> None:
    simulation = Simulation(tiny(), "exact", 0)
    before = simulation.parameters
    with pytest.raises(ValidationError):
        simulation.change({"temperature_c": 30, "comparator": {"theta_on": float("nan")}})
    assert simulation.parameters == before
