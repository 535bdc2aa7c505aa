import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from voltcam_video import Fit, fit, luminance


def test_luminance_weights_colours_by_bt601() -> None:
    colours = np.array([[[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]]], np.uint8)  # B, G, R, white
    assert luminance(colours).tolist() == [[29, 150, 76, 255]]
    with_alpha = np.concatenate([colours, np.zeros((1, 4, 1), np.uint8)], axis=2)
    assert luminance(with_alpha).tolist() == [[29, 150, 76, 255]]


def test_luminance_keeps_what_is_finer_than_8_bits() -> None:
    sixteen = luminance(np.array([[0, 257, 300, 65535]], np.uint16))
    assert sixteen.dtype == np.float32
    np.testing.assert_allclose(sixteen, [[0, 1, 300 / 257, 255]], rtol=1e-6)
    real = luminance(np.array([[0.25, 254.5]]))
    assert real.dtype == np.float32
    assert real.tolist() == [[0.25, 254.5]]


def test_luminance_of_grey_is_itself() -> None:
    grey = np.arange(12, dtype=np.uint8).reshape(3, 4)
    assert np.array_equal(luminance(grey), grey)
    assert np.array_equal(luminance(grey[..., None]), grey)


@pytest.mark.parametrize(
    "image",
    [np.zeros((2, 2, 2), np.uint8), np.zeros(4, np.uint8), np.zeros((2, 2), np.int32), np.zeros((0, 2))],
)
def test_luminance_refuses_what_is_no_image(image: np.ndarray) -> None:
    with pytest.raises(ValueError, match="an image is"):
        luminance(image)


WIDE = np.arange(32, dtype=np.uint8).reshape(4, 8)


def test_crop_takes_the_centre() -> None:
    assert np.array_equal(fit(WIDE, 4, 4, "crop"), WIDE[:, 2:6])
    assert np.array_equal(fit(WIDE.T, 4, 4, "crop"), WIDE.T[2:6])


def test_letterbox_shows_all_between_black_bars() -> None:
    boxed = fit(WIDE + 1, 8, 8, "letterbox")
    assert np.array_equal(boxed[2:6], WIDE + 1)
    assert not boxed[:2].any()
    assert not boxed[6:].any()


def test_shrinking_averages_areas() -> None:
    image = np.array([[0, 100, 10, 20], [50, 50, 30, 40]], np.uint8)
    assert fit(image, 2, 1, "stretch").tolist() == [[50, 25]]


def test_growing_interpolates_between_pixel_centres() -> None:
    assert fit(np.array([[0, 100]], np.uint8), 4, 1, "stretch").tolist() == [[0, 25, 75, 100]]


def test_one_axis_may_shrink_while_the_other_grows() -> None:
    image = np.array([[0, 100, 50, 150]], np.uint8)
    assert fit(image, 2, 3, "stretch").tolist() == [[50, 100]] * 3


def test_the_right_size_is_left_alone() -> None:
    assert fit(WIDE, 8, 4, "crop") is WIDE


sides = st.integers(1, 60)


@given(sides, sides, sides, sides, st.sampled_from(["crop", "letterbox", "stretch"]), st.booleans())
def test_any_size_fits_any_array(
    rows: int, columns: int, height: int, width: int, how: Fit, real: bool
) -> None:
    image = np.full((rows, columns), 77, np.float32 if real else np.uint8)
    fitted = fit(image, width, height, how)
    assert fitted.shape == (height, width)
    assert fitted.dtype == image.dtype
    assert fitted.flags.c_contiguous
    allowed = {0, 77} if how == "letterbox" else {77}
    assert set(np.unique(fitted.round(3))) <= allowed
    assert 77 in fitted.round(3)
