"""Light that the frames of a recording may have been taken of."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter

from ...light.known import Events, KnownLight
from ...light.scene import ENOUGH_EACH, TOLERANCES, Scene
from .settings import RigSettings

LightImage = NDArray[np.float32]
_TOLERANCES = TOLERANCES[:-1]  # 40 % is for calibration only
_LEAN = 0.6 * 32 / 9  # 0.6 of the error half way at a quarter of the way, minus that at three quarters
_FREEDOM = 3  # degrees of freedom of Student's law: 1 % of the light's errors are 4 to 15 times the median


def light_behind(
    scene: Scene, version: int, settings: RigSettings, noisier: bool = False
) -> Iterator[tuple[LightImage, int]]:
    """(H, W) float32 [DN] and its time [us], for each of the scene's images. version: a number. noisier: its
    errors are `RigSettings.noisier` times as large.

    What frames leave open is an error that is nothing at a frame, but for what rounding hides there, and
    largest half way to the next. It is larger where light changes, and is not the same all the way: of
    several events from frame to frame one comes late and the next early. Few errors are large: they are where
    an edge goes by unseen.
    """
    rng = np.random.default_rng(version)
    largest = maximum_filter(scene.surprise.reshape(scene.taken.shape), (1, 3, 3))
    times = settings.noisier if noisier else 1.0
    error = settings.on_curves if scene.on_curves else settings.along_motion
    of_change = error.of_change * scene.surprise_by_change * scene.fall
    shape, last = scene.taken.shape[1:], len(scene.taken_us) - 1
    frame, gap, lean = -1, np.zeros(shape, np.float32), np.zeros(shape, np.float32)
    hidden = np.float16(times) * _hidden_by_rounding(scene, version)
    for image, t_us in zip(scene.images, scene.t_us.tolist(), strict=True):
        while frame < 0 or (frame < last - 1 and t_us > scene.taken_us[frame + 1]):
            frame += 1
            change = scene.taken[frame + 1].astype(np.float32) - scene.taken[frame]
            surprise = np.maximum(largest[frame], largest[frame + 1])
            size = times * np.hypot(error.of_surprise * surprise, of_change * change)
            gap, lean = (size * rng.standard_t(_FREEDOM, shape) for _ in range(2))
        begin_us, end_us = scene.taken_us[frame], scene.taken_us[frame + 1]
        phase = np.float32(np.clip((t_us - begin_us) / (end_us - begin_us), 0, 1))
        middle = 4 * phase * (1 - phase)
        light = image + gap * middle + lean * (_LEAN * middle**2 * (1 - 2 * phase))
        light += (1 - phase) * hidden[frame] + phase * hidden[frame + 1]
        yield np.maximum(light, 0).astype(np.float32), t_us


def known_light(scene: Scene, events: Events) -> KnownLight:
    """Where it is known well enough to say when an event is due, as well as leaves enough events of both
    polarities: leak alone makes only ON, which tells nothing of thresholds.

    Motion is a guess. So light along it is not known where it leaves the straight line from frame to frame,
    nor in the gaps before and behind a surprise: an edge may go by unseen there.
    """
    if scene.on_curves:
        return scene.known(scene.tolerance)
    enough = [min(ENOUGH_EACH, np.count_nonzero(events["p"] == p) / 2) for p in (False, True)]
    for tolerance in _TOLERANCES[:-1]:
        known = _known_to(scene, tolerance)
        on = events["p"][known.within(events)]
        if np.count_nonzero(~on) >= enough[0] and np.count_nonzero(on) >= enough[1]:
            return known
    return _known_to(scene, _TOLERANCES[-1])


def _known_to(scene: Scene, tolerance: float) -> KnownLight:
    known = scene.known(tolerance).all_around()
    return replace(known, gaps=known.gaps & (scene.bow < tolerance))


def _hidden_by_rounding(scene: Scene, version: int) -> NDArray[np.float16]:
    """(M, H, W) [DN]: an error that rounding the frames may have made. Versions come in pairs of either sign,
    so that they are the light as it was found on average."""
    if scene.rounding is None:
        return np.broadcast_to(np.float16(0), scene.taken.shape)
    error: NDArray[np.float16] = scene.rounding[version // 2 % len(scene.rounding)]
    return np.negative(error) if version % 2 else error
