"""Which light is taken between frames."""

import numpy as np

from voltcam_lab.light.between_frames import scene_between, untrusted_share
from voltcam_lab.light.scene import Scene

PERIOD_US, SIDE = 10_000, 32


def waves(pixels_a_frame: float, frames: int = 24) -> np.ndarray:
    """Texture of 5 pixels' wavelength that goes to the right."""
    y, x = np.mgrid[:SIDE, :SIDE]
    moved = [x - pixels_a_frame * k for k in range(frames)]
    light = [110 + 45 * np.sin(2 * np.pi * x / 9) + 45 * np.sin(2 * np.pi * (x + y) / 7) for x in moved]
    return np.rint(light).astype(np.uint8)


def between(frames: np.ndarray, *arguments: object) -> Scene:
    return scene_between(frames, PERIOD_US * np.arange(len(frames)), *arguments)  # type: ignore[arg-type]


def test_slow_light_goes_along_a_cubic() -> None:
    assert between(waves(0.05)).how == "cubic"


def test_of_fast_light_that_with_less_doubt_is_taken() -> None:
    """Doubt of the caller's own: here, of one way or of the other."""
    frames = waves(2.0)
    assert between(frames).trusted().mean() < 0.9
    for wanted in ("cubic", "auto"):
        assert between(frames, None, lambda scene, wanted=wanted: float(scene.how != wanted)).how == wanted


def test_columns_are_those_of_the_whole() -> None:
    """Motion is seen in whole frames, and the surprise is theirs."""
    frames, columns = waves(2.0), np.array([3, 4, 5, 20, 21])
    whole = between(frames, None, untrusted_share)
    part = between(frames, columns, lambda scene: float(scene.how != whole.how))
    assert part.how == whole.how
    np.testing.assert_array_equal(part.images, whole.images[:, :, columns])
    np.testing.assert_array_equal(part.taken, frames[:, :, columns])
    surprise = whole.surprise.reshape(frames.shape)[:, :, columns]
    np.testing.assert_array_equal(part.surprise.reshape(surprise.shape), surprise)
