"""What the search finds of a camera that nothing of ours has made, and how close it comes elsewhere."""

import numpy as np
import pytest
from tests.lab.calibration.refine.made import (
    BASE,
    HEIGHT,
    LATE_US,
    START,
    TRUTH,
    WIDTH,
    Recording,
)

from voltcam_lab.calibration.refine.coordinates import ABSENT, PLACES, point_of, response
from voltcam_lab.calibration.refine.refinement import Refined, Refinement
from voltcam_lab.calibration.refine.replay import Replay
from voltcam_lab.distances import FrameLight, Region, Yardstick
from voltcam_lab.distances.goal import Goal
from voltcam_lab.light.scene import scene_of
from voltcam_lab.models.model import MODELS, simulate


@pytest.fixture(scope="module")
def recording() -> Recording:
    return Recording()


@pytest.fixture(scope="module")
def refined(recording: Recording) -> Refined:
    steps: list[str] = []
    late = START.changed({"latency": {"delay_us": LATE_US}})  # is found before, by the lag
    found = Refinement(
        recording.events, recording.scene, recording.light, recording.fitting, 1, steps.append
    ).refined(late)
    assert all(step.startswith("refine: ") for step in steps)
    return found


def test_what_was_not_looked_at_comes_closer(recording: Recording, refined: Refined) -> None:
    """As close as the camera's own parameters are, within the luck of patterns and of few events."""
    yardstick = Yardstick(recording.events, recording.judging, recording.light)
    before, after, best = (
        yardstick.distances(simulate(MODELS["exact"](WIDTH, HEIGHT, parameters, 1), scene))
        for parameters, scene in (
            (START, recording.scene),
            (refined.parameters, refined.scene),
            (TRUTH, recording.scene),
        )
    )
    for name in ("W1", "pair", "TVs"):
        assert after[name] < min(0.75 * before[name], 1.25 * best[name]), name
    assert after["b4"] > before["b4"]
    assert refined.after < refined.before / 2


def test_parameters_are_those_of_the_camera(refined: Refined) -> None:
    """One recording, one seed: tolerances are several times what other seeds differ by."""
    found = refined.parameters
    front_end = found.photoreceptor_bandwidth
    cutoff_hz, follower_hz = front_end.cutoff_hz or np.inf, front_end.follower_hz or np.inf
    slower_us = (2e6 / cutoff_hz + 1e6 / follower_hz) / (2 * np.pi)
    assert found.latency.delay_us + slower_us == pytest.approx(LATE_US)
    assert found.comparator.theta_on / found.comparator.theta_off == pytest.approx(1.44, rel=0.12)
    change = response(point_of(found), np.array([40.0, 160.0]))[1]  # however bent
    assert change == pytest.approx(BASE.k1 * np.log((160 + BASE.k2) / (40 + BASE.k2)), rel=0.12)
    assert {"threshold_spread", "reset_spread"} & set(refined.kept)
    assert 0.08 < np.hypot(found.threshold_mismatch.sigma, found.reset_noise.sigma) < 0.35


def test_what_is_not_there_is_not_kept(refined: Refined) -> None:
    assert not {"pairs_hz", "hot", "k4_per_us", "k5_per_dn_us"} & set(refined.kept)
    assert {*refined.kept, *refined.dropped} == set(ABSENT)
    for name, absent in ABSENT.items():
        effect, parameter = PLACES[name]
        is_there = getattr(getattr(refined.parameters, effect), parameter) != absent
        assert is_there == (name in refined.kept), name


def test_a_follower_that_is_as_slow_in_any_light_is_told_from_a_delay() -> None:
    """Bars go by within 3 ms, at 1000 frames a second. START had a delay in place of the follower."""
    t_us, x = np.arange(0, 400_001, 1000), np.arange(48)
    phase = 2 * np.pi * (x / 24 - t_us[:, None] * 12e-6)
    bars = np.tile((40 + 120 / (1 + np.exp(-6 * np.sin(phase))))[:, None], (1, 24, 1)).astype(np.float32)
    truth = START.changed({"photoreceptor_bandwidth": {"cutoff_hz": 2e4, "follower_hz": 80}})
    events = simulate(MODELS["exact"](48, 24, truth, 7), scene_of(bars, t_us, "linear"))
    late_us = 1e6 / (2 * np.pi * 80)
    found = Refinement(
        events, scene_of(bars, t_us, "linear"), FrameLight(bars, t_us), Region.whole(48, 24, 0, 400_000), 1
    ).refined(START.changed({"latency": {"delay_us": late_us}}), same_light=True)
    assert "follower_hz" in found.kept
    assert 60 < found.parameters.photoreceptor_bandwidth.follower_hz < 110
    assert abs(found.parameters.latency.delay_us) < 0.3 * late_us


def test_the_score_of_the_recording_is_nothing(recording: Recording) -> None:
    goal = Goal(recording.events, recording.fitting, recording.light)
    assert goal.score(recording.events) == 0
    assert goal.score(recording.events[::2]) > 0.1


def test_a_replay_gives_the_events_of_its_region_only(recording: Recording) -> None:
    """Pixel by pixel as many as the whole sensor gives, but for its random numbers."""
    parameters = START.changed({"photon_noise": {"k3": 0.0}, "leak_noise": {"k6": 0.0}})
    some = Replay.of(recording.scene, recording.fitting).events(parameters, 1)
    everything = simulate(MODELS["exact"](WIDTH, HEIGHT, parameters, 1), recording.scene)
    assert recording.fitting.pixels[some["y"], some["x"]].all()
    one, other = recording.fitting.of(some), recording.fitting.of(everything)
    assert one.size == pytest.approx(other.size, rel=0.02)


def test_events_are_of_the_light_of_when_they_were_due(recording: Recording) -> None:
    """In every other 60 ms frames show noise that no pixel saw, and events come 3 ms late. So in the first
    3 ms of known light they are of light that nobody knows. The gain is found all the same."""
    rng, frames = np.random.default_rng(2), recording.scene.taken.copy()
    noisy = np.arange(len(frames)) // 6 % 2 == 1
    frames[noisy] = rng.integers(20, 235, frames[noisy].shape)
    scene = scene_of(frames, recording.scene.taken_us, "cubic")
    late = START.changed({"latency": {"delay_us": LATE_US}})
    refinement = Refinement(recording.events, scene, recording.light, recording.fitting, 1)
    found = refinement.refined(late, same_light=True).parameters
    change = response(point_of(found), np.array([40.0, 160.0]))[1]
    assert change == pytest.approx(BASE.k1 * np.log((160 + BASE.k2) / (40 + BASE.k2)), rel=0.12)
