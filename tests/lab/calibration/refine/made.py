"""A camera that nothing of ours has made, and a small scene."""

import numpy as np
from tests.generator import Effect, draw_scene, record
from tests.generator.base import Base

from voltcam_lab.distances import FrameLight, Region, held_out
from voltcam_lab.light.scene import Scene, scene_of
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


def wave(seconds: float = 0.4) -> Scene:
    """A plaid that moves over 24 x 24 pixels, 100 frames a second."""
    y, x = np.indices((24, 24))
    t_us = np.arange(0, round(seconds * 1e6) + 1, 10_000)
    images = [110 + 60 * np.sin((x + y / 2 - t / 20_000) / 2) for t in t_us]
    return scene_of(np.array(images, np.float32), t_us, "linear")
