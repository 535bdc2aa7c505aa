"""Twins: recordings the model makes of the same scene, where the truth is known."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import EVENT, Parameters, Simulator

from .scene import Scene


def twin(scene: Scene, parameters: Parameters, seed: int, bend_error: float = 0.0) -> NDArray[np.void]:
    """Events (EVENT) of the model on light that the frames may have shown.

    The frames do not fix the light: it is drawn anew from what they leave open (`light_behind`).
    """
    simulator = Simulator(scene.width, scene.height, parameters, seed=seed)
    found = [
        simulator.advance(image, t_us)
        for image, t_us in light_behind(scene, np.random.default_rng(seed), bend_error)
    ]
    return np.concatenate([np.empty(0, EVENT), *found])


def light_behind(
    scene: Scene, rng: np.random.Generator, bend_error: float
) -> Iterator[tuple[NDArray[np.float32], int]]:
    """Light that the frames may have been taken of: (H, W) float32 [DN] and its time [us].

    Whole grey levels are roundings: each stands for any light within half a level, the same as long as it does
    not change. Between frames the light is off by `bend_error` times `Scene.doubt`, normally.
    """
    shape = (scene.height, scene.width)
    whole = np.issubdtype(scene.taken.dtype, np.integer)

    def rounded_off(frame: int, former: NDArray[np.float32] | None) -> NDArray[np.float32]:
        if not whole:
            return np.zeros(shape, np.float32)
        anew = rng.random(shape, np.float32) - np.float32(0.5)
        return (
            anew if former is None else np.where(scene.taken[frame] == scene.taken[frame - 1], former, anew)
        )

    pixel, frame = np.arange(shape[0] * shape[1], dtype=np.int32), 0
    now = rounded_off(0, None)
    later, gap = rounded_off(1, now), rng.standard_normal(shape, np.float32)
    for image, t_us in zip(scene.images, scene.t_us.tolist(), strict=True):
        while frame < len(scene.taken_us) - 2 and t_us > scene.taken_us[frame + 1]:
            frame += 1
            now, later = later, rounded_off(frame + 1, later)
            gap = rng.standard_normal(shape, np.float32)
        span_us = scene.taken_us[frame + 1] - scene.taken_us[frame]
        phase = np.float32(min(max((t_us - scene.taken_us[frame]) / span_us, 0.0), 1.0))
        light = image + (1 - phase) * now + phase * later
        if bend_error > 0:
            light += bend_error * gap * scene.doubt(pixel, np.full(pixel.size, float(t_us))).reshape(shape)
        yield np.maximum(light, 0).astype(np.float32), t_us
