"""Light that the frames of a recording may have been taken of."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ...light.scene import Scene

LIGHTS = ((0.0, 0.4), (-0.3, 0.55), (0.15, 0.4), (-0.15, 0.55))
"""Versions of the light between frames that a cubic tells: how much more it bends than `Scene.images` (-1 is
straight), and a random error as a share of `Scene.surprise`, the error that left-out frames show. What frames
leave open must not look like a gap. Development: about what recordings without an effect ask for."""
MOVED_LIGHTS = ((0.0, 0.4), (-0.6, 0.6), (0.3, 0.4), (-0.3, 0.6))
"""Versions of the light where motion had to be guessed."""

LightImage = NDArray[np.float32]


def light_behind(scene: Scene, version: int) -> Iterator[tuple[LightImage, int]]:
    """(H, W) float32 [DN] and its time [us], for each of the scene's images."""
    rng = np.random.default_rng(version)
    more, error = (LIGHTS if scene.how == "cubic" else MOVED_LIGHTS)[version]
    shape, last = scene.taken.shape[1:], len(scene.taken_us) - 1
    frame, gap = -1, np.zeros(shape, np.float32)
    for image, t_us in zip(scene.images, scene.t_us.tolist(), strict=True):
        while frame < 0 or (frame < last - 1 and t_us > scene.taken_us[frame + 1]):
            gap, frame = rng.standard_normal(shape, np.float32), frame + 1
        begin_us, end_us = scene.taken_us[frame], scene.taken_us[frame + 1]
        phase = np.float32(np.clip((t_us - begin_us) / (end_us - begin_us), 0, 1))
        straight = (1 - phase) * scene.taken[frame] + phase * scene.taken[frame + 1]
        uncertainty = (
            4
            * phase
            * (1 - phase)
            * np.maximum(scene.surprise[frame], scene.surprise[frame + 1]).reshape(shape)
        )
        light = image + more * (image - straight) + error * gap * uncertainty
        yield np.maximum(light, 0).astype(np.float32), t_us
