"""Recordings of other makes: pixels of ESIM and v2e as their papers have them, on scenes of the generator.

They share effects with the catalogue, and not its base: ESIM has next to no dark level and no noise at all;
v2e is linear below 20 DN, and its shot noise is another. Both are shown the scene every STEP_US.
"""

from dataclasses import dataclass

import numpy as np
from tests.generator import Recorded, Scene

from voltcam_lab.models.esim import Esim, EsimParameters
from voltcam_lab.models.v2e import V2e, V2eParameters

STEP_US = 50
LEAD_IN_US = 500_000
BATCH = 2000  # images in memory


@dataclass(frozen=True)
class Make:
    """A camera. shares: what of it the catalogue has, by the registry's names."""

    camera: str
    pixel: EsimParameters | V2eParameters
    shares: tuple[str, ...] = ()


def _esim(*shares: str, off: float = 0.25, sigma: float = 0.0, dead_us: float = 0.0) -> Make:
    return Make("esim", EsimParameters(0.25, off, sigma, dead_us), shares)


def _v2e(*shares: str, **given: float) -> Make:
    silent = {"theta_sigma": 0.0, "leak_rate_hz": 0.0, "leak_jitter": 0.0, "leak_mismatch_decades": 0.0}
    return Make("v2e", V2eParameters(**{**silent, **given}), shares)


MAKES = {
    "esim": _esim(),
    "esim, thresholds of 10%": _esim("threshold_mismatch", sigma=0.025),
    "esim, dead for 3 ms": _esim("refractory_period", dead_us=3000),
    "esim, OFF at 0.32": _esim("comparator", off=0.32),
    "v2e": _v2e(),
    "v2e, thresholds of 15%": _v2e("threshold_mismatch", theta_sigma=0.03),
    "v2e, 60 Hz": _v2e("photoreceptor_bandwidth", cutoff_hz=60),
    "v2e, 5 Hz of noise": _v2e("low_light_shot_noise", shot_noise_rate_hz=5),
    "v2e, OFF at 0.28": _v2e("comparator", theta_off=0.28),
    "v2e, noisy": Make("v2e", V2eParameters.noisy(), (
        "threshold_mismatch", "photoreceptor_bandwidth", "low_light_shot_noise", "leak_mismatch",
    )),
}  # fmt: skip


def made(make: Make, scene: Scene, seconds: float, fps: float, seed: int) -> Recorded:
    """Frames are of 8 bit, as of `record`; an event comes at any microsecond of its step."""
    kind = Esim if isinstance(make.pixel, EsimParameters) else V2e
    camera = kind(scene.width, scene.height, make.pixel, seed)  # type: ignore[arg-type]
    t_us = np.arange(-LEAD_IN_US, round(seconds * 1e6) + 1, STEP_US)
    found = []
    for batch in np.split(t_us, range(BATCH, t_us.size, BATCH)):
        for image, at_us in zip(scene.radiance(batch), batch.tolist(), strict=True):
            found.append(camera.advance(image, at_us))
    events = np.concatenate(found)
    events["t"] -= np.random.default_rng(seed).integers(0, STEP_US, events.size)
    events = events[events["t"] >= 0]
    frame_t_us = np.arange(0, round(seconds * 1e6) + 1, round(1e6 / fps))
    frames = np.clip(np.rint(scene.radiance(frame_t_us)), 0, 255).astype(np.uint8)
    return Recorded(
        events[np.argsort(events["t"], kind="stable")], frames, frame_t_us, scene.width, scene.height,
        {"base": {"camera": make.camera}},
    )  # fmt: skip
