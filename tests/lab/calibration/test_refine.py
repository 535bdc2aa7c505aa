"""A camera that nothing of ours has made: what the search finds of it, and that it comes closer where it did
not look."""

from dataclasses import replace

import numpy as np
import pytest
from tests.generator import Effect, draw_scene, record
from tests.generator.base import Base

from voltcam_lab.calibration.refine.coordinates import parameters_at, point_of, response
from voltcam_lab.calibration.refine.goal import Goal
from voltcam_lab.calibration.refine.refine import Refined, refine
from voltcam_lab.calibration.refine.replay import Replay
from voltcam_lab.distances import FrameLight, Region, Yardstick, held_out
from voltcam_lab.light.between_frames import calmed, evened, sharpened
from voltcam_lab.light.scene import Scene, scene_of
from voltcam_lab.models.model import MODELS, simulate
from voltcam_simulator import Parameters

WIDTH, HEIGHT, SECONDS, LATE_US = 72, 48, 2.4, 3000
BASE = Base("none", k1=12.0, k2=20.0, k3=1e-4, k4=0.0, k5=0.0, k6=1e-5, theta_on=1.2, theta_off=1 / 1.2)
HIDDEN = (
    Effect("threshold_mismatch", "", {"sigma": 0.15, "log_normal": 0.0}),
    Effect("reset_noise", "", {"sigma": 0.15}),
)
START = Parameters().changed({
    "contrast_response": {"k1": 9.0, "k2_dn": 20.0},
    "photon_noise": {"k3": 1e-4},
    "leak_noise": {"k6": 1e-5},
    "reset_noise": {"sigma": 0.1},
    "threshold_mismatch": {"sigma": 0.1},
})  # fmt: skip

TRUTH = START.changed({
    "contrast_response": {"k1": BASE.k1},
    "comparator": {"theta_on": BASE.theta_on, "theta_off": BASE.theta_off},
    "threshold_mismatch": {"sigma": 0.15},
    "reset_noise": {"sigma": 0.15},
    "latency": {"delay_us": LATE_US},
})  # fmt: skip


class Recording:
    """Events 3 ms late, of a camera with hidden effects; frames at 100 fps."""

    def __init__(self) -> None:
        scene = draw_scene(np.random.default_rng(5), WIDTH, HEIGHT, SECONDS)
        made = record(scene, BASE, HIDDEN, SECONDS, fps=100, seed=3)
        self.events = made.events.copy()
        self.events["t"] += LATE_US
        self.scene = scene_of(made.frames, made.frame_t_us, "cubic")
        self.light = FrameLight(made.frames, made.frame_t_us)
        whole = Region.whole(WIDTH, HEIGHT, 0, int(made.frame_t_us[-1]))
        self.fitting, self.judging = held_out(whole)


@pytest.fixture(scope="module")
def recording() -> Recording:
    return Recording()


@pytest.fixture(scope="module")
def refined(recording: Recording) -> Refined:
    steps: list[str] = []
    found = refine(
        recording.events, recording.scene, recording.light, recording.fitting, START, 1, steps.append
    )
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
    assert found.latency.delay_us == pytest.approx(LATE_US, abs=900)  # frames are 10 ms apart
    assert found.comparator.theta_on / found.comparator.theta_off == pytest.approx(1.44, rel=0.12)
    change = response(point_of(found), np.array([40.0, 160.0]))[1]  # however bent
    assert change == pytest.approx(BASE.k1 * np.log((160 + BASE.k2) / (40 + BASE.k2)), rel=0.12)
    assert {"threshold_spread", "reset_spread"} & set(refined.kept)
    assert 0.08 < np.hypot(found.threshold_mismatch.sigma, found.reset_noise.sigma) < 0.35


def test_what_is_not_there_is_not_kept(refined: Refined) -> None:
    assert not {"pairs_hz", "hot", "k4_per_us", "k5_per_dn_us"} & set(refined.kept)
    assert set(refined.kept).isdisjoint(refined.dropped)


def test_coordinates_are_the_camera() -> None:
    """Thresholds of any unit become those whose geometric mean is 1; the rest goes with them."""
    camera = START.changed({
        "comparator": {"theta_on": 3.0, "theta_off": 0.75},
        "input_response": {"gamma_exponent": 0.7},
        "reset_noise": {"sigma": 0.15},
    })  # fmt: skip
    found = parameters_at(point_of(camera), camera)
    assert found.comparator.theta_on == pytest.approx(2.0)
    assert found.comparator.theta_off == pytest.approx(0.5)
    assert found.contrast_response.k1 == pytest.approx(9.0 / 1.5)
    assert found.contrast_response.k2_dn == pytest.approx(20.0)
    assert found.reset_noise.sigma == pytest.approx(0.1)
    assert found.input_response.gamma_exponent == pytest.approx(0.7)


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


def test_noise_is_calmed_where_nothing_moves() -> None:
    rng = np.random.default_rng(0)
    frames = np.full((20, 40, 60), 100.0)
    frames[:, :, 30:] += 20 * np.sin(np.arange(30) - np.arange(20)[:, None, None])
    noisy = frames + rng.normal(0, 1, frames.shape)
    found = calmed(scene_of(noisy.astype(np.float32), np.arange(20) * 10_000, "linear")).taken
    assert np.std((found - frames)[5:15, :, :20]) < 0.6
    assert np.abs(found - noisy)[5:15, :, 35:].max() < 0.1


def test_images_between_frames_are_as_sharp_as_the_others() -> None:
    rng = np.random.default_rng(1)
    sharp = (60 + 40 * rng.random((3, 40, 40))).astype(np.float32)
    blurred = np.mean([np.roll(sharp, (dy, dx), (1, 2)) for dy in (0, 1) for dx in (0, 1)], axis=0)
    images = np.stack([sharp[0], blurred[0], sharp[1], blurred[1], sharp[2]]).astype(np.float32)
    taken_us = np.array([0, 20_000, 40_000])
    scene = Scene(sharp, taken_us, images, np.arange(5) * 10_000)
    before, after = (np.abs(np.diff(each, axis=2)).mean((1, 2)) for each in (images, evened(scene).images))
    assert np.ptp(before) > 0.3 * before.mean()
    assert np.ptp(after) < 0.1 * after.mean()


def test_sharpening_is_undone_by_its_blur() -> None:
    """Light is never below 0; flat light stays as it is."""
    flat = np.full((2, 8, 8), 7.0, np.float32)
    scene = Scene(flat, np.array([0, 10]), flat, np.array([0, 10]))
    assert (sharpened(scene, 0.5).images == flat).all()
    edge = replace(scene, images=np.where(np.arange(8) < 4, 0, 200) * np.ones_like(flat))
    assert sharpened(edge, 0.5).images.min() == 0
    assert sharpened(edge, 0.5).images.max() > 200
