"""More than the machine can do: bounded, said, counted, and over when its cause is."""

import threading
import time
from pathlib import Path

import numpy as np
import pytest

from voltcam_server.emulator import Emulator
from voltcam_server.overload import BUSY, MOST_STEPS, TOO_FAST, OverloadSettings, coarser
from voltcam_server.simulation import Simulation
from voltcam_simulator import Camera, Limits, Parameters, Simulator
from voltcam_video import SourceRequest

from .rig import SCENE, arrival, emulating, gap_free, in_order, moving_frames, save_frames, tiny, until

TOO_MANY = [
    {"noise_pairs": {"rate_hz": 10_000, "half_dn": 100_000}},
    {"hot_pixels": {"fraction": 1, "rate_hz": 100_000, "spread_decades": 2}},
    {"junction_leak": {"k4_per_us": 1}},
    {"comparator": {"theta_on": 0.05, "theta_off": 0.05}, "leak_noise": {"k6": 1}},
]


def state(emulator: Emulator) -> str:
    return emulator.status.state


@pytest.mark.parametrize("changes", TOO_MANY)
def test_too_many_events_are_skipped_and_counted(changes: dict[str, dict[str, float]]) -> None:
    simulation = Simulation(tiny(), "exact", 0, overload=OverloadSettings(most_events=10_000))
    grey = np.full((16, 24), 50, np.uint8)
    simulation.step(arrival(grey, 0))
    simulation.change(changes)
    skipped = simulation.step(arrival(grey, 1_000_000))
    assert skipped is not None
    assert (skipped.events.size, skipped.end_us) == (0, 1_000_000)
    assert (simulation.simulated, simulation.skipped, simulation.skipped_us) == (1, 1, 1_000_000)
    assert "10000 events" in simulation.load.trouble
    simulation.change(Parameters().model_dump())
    after = [simulation.step(arrival(grey, 1_000_000 + 10_000 * i)) for i in range(1, 40)]
    assert all(step is not None and step.events.size < 500 for step in after)
    assert simulation.simulated == 40


def test_a_long_time_between_two_frames_is_skipped() -> None:
    simulation = Simulation(tiny(), "exact", 0, overload=OverloadSettings(longest_interval_us=100_000))
    grey = np.full((16, 24), 50, np.uint8)
    for t_us in (0, 100_000, 200_001):
        simulation.step(arrival(grey, t_us))
    assert (simulation.simulated, simulation.skipped, simulation.skipped_us) == (2, 1, 100_001)
    assert "longest_interval_us" in simulation.load.trouble


def test_where_frames_were_dropped_events_are_those_between_two_frames_in_a_row() -> None:
    """As of a sensor that looks away for a while, so that one interval costs what one costs."""
    camera = tiny()
    images = moving_frames(6, camera)
    simulation, simulator = Simulation(camera, "exact", 5), Simulator(24, 16, camera.parameters, seed=5)
    simulation.step(arrival(images[0], 0))
    simulation.load.worked(1.0, 10_000)  # a hundred times too slow
    skipped = simulation.step(arrival(images[4], 40_000, missed=3))
    interval = simulation.step(arrival(images[5], 50_000))
    simulator.advance(images[0], 0)
    simulator.jump(images[4], 40_000)
    assert skipped is not None
    assert interval is not None
    assert (skipped.events.size, simulation.skipped_us) == (0, 40_000)
    np.testing.assert_array_equal(interval.events, simulator.advance(images[5], 50_000))
    assert interval.events.size > 100


def test_what_a_fast_machine_was_late_for_is_not_skipped() -> None:
    camera = tiny()
    images = moving_frames(6, camera)
    simulation, simulator = Simulation(camera, "exact", 5), Simulator(24, 16, camera.parameters, seed=5)
    simulation.load.worked(0.0001, 10_000)
    for step in (
        simulation.step(arrival(images[0], 0)),
        simulation.step(arrival(images[4], 40_000, missed=3)),
    ):
        assert step is not None
    simulator.advance(images[0], 0)
    np.testing.assert_array_equal(step.events, simulator.advance(images[4], 40_000, Limits(4)))
    assert simulation.skipped == 0


@pytest.mark.parametrize(("took_s", "said"), [(0.001, BUSY), (0.015, TOO_FAST)])
def test_why_frames_are_dropped_is_said_by_how_long_one_takes(took_s: float, said: str) -> None:
    """Every other frame of 100 a second is dropped. Where one takes 15 ms that leaves a load below 1."""
    simulation = Simulation(tiny(), "exact", 0)
    grey = np.full((16, 24), 50, np.uint8)
    simulation.step(arrival(grey, 0))
    for _ in range(20):
        simulation.load.worked(took_s, 20_000, missed=1)
    assert simulation.load.trouble == ""
    simulation.step(arrival(grey, 20_000, missed=1))
    assert simulation.load.trouble == said
    assert simulation.load.ratio < 1


def test_steps_of_an_interval_are_bounded() -> None:
    assert coarser(33_333, np.inf, 90_000) == 1
    assert coarser(33_333, 4200, 90_000) == 1
    assert 33_333 / (1.0 * coarser(33_333, 1.0, 64)) <= MOST_STEPS
    assert coarser(33_333, 4200, 8192 * 8192) == pytest.approx(33_333 / 4200)  # one step


def test_many_frames_of_the_readout_in_one_interval_take_no_minutes() -> None:
    readout = {"frame_period_us": 1000, "exposure_us": 1e6, "row_us": 1e4, "readout_kick": 1, "reset_kick": 1}
    simulation = Simulation(tiny(aps_coupling=readout), "exact", 0)
    began_s = time.monotonic()
    for i in range(3):
        simulation.step(arrival(np.full((16, 24), 50, np.uint8), 1_000_000 * i))
    assert time.monotonic() - began_s < 20


@pytest.mark.parametrize("changes", [TOO_MANY[0], TOO_MANY[2]])
def test_overload_is_a_state_and_not_the_end(changes: dict[str, dict[str, float]]) -> None:
    camera = tiny()
    with emulating(SCENE, camera, overload=OverloadSettings(most_events=20_000)) as (emulator, listener):
        until(lambda: state(emulator) == "running", "it runs")
        emulator.simulation.change(changes)
        until(lambda: state(emulator) == "overloaded", "too many events are said")
        assert "20000 events between two frames" in emulator.status.reason
        emulator.simulation.change(camera.parameters.model_dump())
        until(lambda: state(emulator) == "running", "it recovers")
        count = len(listener.packets)
        listener.wait(lambda it: len(it.packets) > count + 50)
        frames = emulator.status.frames
        assert frames.skipped > 0
    assert gap_free(listener)
    assert in_order(listener)


def test_a_camera_recovers_from_thresholds_that_were_turned_down() -> None:
    """346 x 260 pixels, 60 frames/s: with times copied for each slice its age rose without end."""
    source = SourceRequest(uri="scene", fps=60, width=346, height=260)
    with emulating(source, Camera.load("typical")) as (emulator, listener):
        listener.wait(lambda it: len(it.frames) > 20)
        emulator.simulation.change({"comparator": {"theta_on": 0.05, "theta_off": 0.05}})
        time.sleep(4)
        assert emulator.status.latency.age_ms < 5000
        emulator.simulation.change({"comparator": {"theta_on": 1, "theta_off": 1}})
        until(lambda: emulator.status.latency.age_ms < 200, "what is sent is new again")
        listener.packets.clear()


def test_a_stall_is_said() -> None:
    with emulating(SCENE) as (emulator, _):
        until(lambda: state(emulator) == "running", "it runs")
        follow, go = emulator.simulation.follow, threading.Event()
        emulator.simulation.follow = lambda *given: (go.wait(20), follow(*given))[1]  # type: ignore[method-assign]
        until(lambda: state(emulator) == "stalled", "the stall is said")
        assert emulator.status.latency.age_ms > 2000
        go.set()
        until(lambda: state(emulator) == "running", "it runs again")


def test_a_source_that_is_over_is_said(tmp_path: Path) -> None:
    uri = save_frames(tmp_path / "few.npz", moving_frames(5, tiny()))
    with emulating(SourceRequest(uri=uri)) as (emulator, _):
        until(lambda: state(emulator) == "ended", "its end is said")
        assert "end" in emulator.status.reason


def test_an_interval_that_takes_too_long_is_given_up() -> None:
    """Few events, many steps: bounded by time alone."""
    overload = OverloadSettings(longest_work_s=0.01)
    simulation = Simulation(Camera(name="large", width=800, height=600), "exact", 0, overload=overload)
    simulation.change({"flicker": {"frequency_hz": 1000, "depth": 0.1}})
    grey = np.full((600, 800), 50, np.uint8)
    simulation.step(arrival(grey, 0))
    simulation.step(arrival(grey + 50, 900_000))
    assert simulation.skipped == 1
    assert "takes more than 0.01 s" in simulation.load.trouble
