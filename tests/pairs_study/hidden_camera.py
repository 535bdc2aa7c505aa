"""A camera with all that a real one has, by the generator, and a camera file with its true values."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from tests.generator import Base, Effect, draw_base

from voltcam_simulator import Parameters

MIDDLE_DN, WHITE_DN = 128.0, 255.0  # where a bandwidth is given, there and here
SLOWEST_DN = 255 / 9  # the generator leaves a tenth of white's bandwidth at 0 DN


@dataclass(frozen=True)
class HiddenCamera:
    """base, effects: by the generator's names and units. Frames come frame_us apart, exposed for exposure_us,
    which is a camera's setting."""

    base: Base
    effects: tuple[Effect, ...]
    frame_us: float
    exposure_us: float


def draw_camera(rng: np.random.Generator, fps: float) -> HiddenCamera:
    """Parameters of the published sets, each off by up to 30 %, and a leak that is a half to a fiftieth of
    theirs, as a real DAVIS346 has it. Sizes of effects are log-uniform."""

    def between(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    base = draw_base(rng)
    less = between(0.02, 0.5)
    base = replace(base, k4=base.k4 * less, k5=base.k5 * less)
    exposure_us = between(500, 1500)
    sizes: dict[str, dict[str, float]] = {
        "refractory_period": {"period_us": between(100, 1500)},
        "photoreceptor_bandwidth": {
            "cutoff_hz": (cutoff := between(80, 800)),
            "at_dn": MIDDLE_DN,
            "follower_hz": 8 * cutoff,
        },
        "threshold_mismatch": {"sigma": between(0.03, 0.15), "log_normal": float(rng.integers(2))},
        "reset_noise": {"sigma": between(0.03, 0.15)},
        "leak_mismatch": {"sigma": between(0.1, 0.5)},
        "low_light_shot_noise": {"c": between(0.001, 0.005), "dark_dn": float(rng.uniform(3, 8))},
        "crosstalk": {"kick": between(0.002, 0.02)},
        "aps_coupling": {
            "kick": between(0.01, 0.05),
            "exposure_us": exposure_us,
            "pulse_us": float(rng.uniform(500, 1000)),
            "row_us": 35.25,
        },
        "hot_pixels": {
            "fraction": between(0.001, 0.005),
            "mean_hz": float(rng.uniform(20, 60)),
            "on_share": 0.95,
        },
        "latency": {"jitter_us": between(20, 300), "delay_us": between(50, 3000)},
        "readout": {"us_per_event": between(0.5, 5)},
    }
    effects = tuple(Effect(name, "medium", values) for name, values in sizes.items())
    return HiddenCamera(base, effects, 1e6 / fps, exposure_us)


def true_file(camera: HiddenCamera, height: int) -> Parameters:
    """The hidden values in the simulator's terms. Its forms differ in part: here an exposure's kick ends for
    all rows at once, the bus serves rows in the order of asking, and every hot pixel draws its own rate."""
    base, hidden = camera.base, {effect.name: effect.parameters for effect in camera.effects}
    aps, hot, latency = hidden["aps_coupling"], hidden["hot_pixels"], hidden["latency"]
    begin_us = -camera.exposure_us / 2 - height * aps["row_us"]
    bandwidth, shot = hidden["photoreceptor_bandwidth"], hidden["low_light_shot_noise"]
    known: dict[str, dict[str, Any]] = {
        "contrast_response": {"k1": base.k1, "k2_dn": base.k2},
        "comparator": {"theta_on": base.theta_on, "theta_off": base.theta_off},
        "photon_noise": {"k3": base.k3},
        "junction_leak": {"k4_per_us": base.k4},
        "parasitic_photocurrent": {"k5_per_dn_us": base.k5},
        "leak_noise": {"k6": base.k6},
        "refractory_period": hidden["refractory_period"],
        "photoreceptor_bandwidth": {
            "cutoff_hz": bandwidth["cutoff_hz"] * (WHITE_DN + SLOWEST_DN) / (MIDDLE_DN + SLOWEST_DN),
            "dark_dn": SLOWEST_DN,
            "follower_hz": bandwidth["follower_hz"],
        },
        "threshold_mismatch": {"sigma": hidden["threshold_mismatch"]["sigma"]},
        "reset_noise": hidden["reset_noise"],
        "leak_mismatch": hidden["leak_mismatch"],
        "low_light_shot_noise": {"c": shot["c"], "dark_dn": shot["dark_dn"]},
        "crosstalk": {"coupling": hidden["crosstalk"]["kick"]},
        "aps_coupling": {
            "frame_period_us": camera.frame_us,
            "exposure_us": aps["exposure_us"],
            "row_us": aps["row_us"],
            "line_us": aps["pulse_us"],
            "offset_us": begin_us,
            "exposure_kick": aps["kick"],
            "readout_kick": -aps["kick"],
        },
        "hot_pixels": {"fraction": hot["fraction"], "rate_hz": hot["mean_hz"], "on_share": hot["on_share"]},
        "latency": latency,
        "readout": {"row_us": 0.0, "event_us": hidden["readout"]["us_per_event"]},
    }
    return Parameters().changed(known)
