import numpy as np
import pytest

from voltcam_video.photos import light_of, smaller

# IEC 61966-2-1: (c / 12.92) up to 0.04045, ((c + 0.055) / 1.055) ** 2.4 above
GREYS = {0: 0.0, 10: 255 * (10 / 255) / 12.92, 188: 255 * ((188 / 255 + 0.055) / 1.055) ** 2.4, 255: 255.0}


@pytest.mark.parametrize(("coded", "light"), GREYS.items())
def test_srgb_is_decoded(coded: int, light: float) -> None:
    for photograph in (np.uint8(coded), np.uint16(coded * 257)):
        grey = np.full((2, 3), photograph)
        for image in (grey, grey[..., None], np.repeat(grey[..., None], 3, axis=2)):
            np.testing.assert_allclose(light_of(image), np.full((2, 3), light), rtol=2e-6)


def test_colours_add_as_light_does() -> None:
    blue, green, red = np.eye(3, dtype=np.uint8)[:, None, None, :] * np.uint8(255)
    for image, share in ((blue, 0.0722), (green, 0.7152), (red, 0.2126)):
        np.testing.assert_allclose(light_of(image), [[255 * share]], rtol=1e-6)


def test_an_alpha_channel_is_ignored_and_floats_are_light() -> None:
    grey = np.full((2, 2, 4), (100.0, 100.0, 100.0, 3.0), np.float32)
    np.testing.assert_allclose(light_of(grey), np.full((2, 2), 100.0), rtol=1e-6)


def test_smaller_ones_average_areas_by_a_whole_factor() -> None:
    light = np.arange(7 * 9, dtype=np.float32).reshape(7, 9)
    made = smaller(light, 4)
    assert made.shape == (2, 3)
    np.testing.assert_allclose(made[1, 2], light[3:6, 6:9].mean())
    np.testing.assert_array_equal(smaller(light, 9), light)
    assert smaller(np.ones((1, 50), np.float32), 10).shape == (1, 10)


@pytest.mark.parametrize(
    "image",
    [np.zeros(3, np.uint8), np.zeros((0, 3), np.uint8), np.zeros((2, 2, 2), np.uint8), np.eye(2, dtype=int)],
)
def test_what_is_no_photograph_is_refused(image: np.ndarray) -> None:
    with pytest.raises(ValueError, match="a photograph is"):
        light_of(image)
