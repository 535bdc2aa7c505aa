"""Images of ROS messages: encodings, byte orders, padding, files, and whatever is none of them."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from voltcam_client.errors import PacketError
from voltcam_client.pushed_frame import ENCODINGS
from voltcam_video import luminance
from voltcam_video.sources.image_message import ALIASES, compressed_image, raw_image

RNG = np.random.default_rng(1)
BGR = RNG.integers(0, 256, (5, 7, 3), np.uint8)
DEEP = RNG.integers(0, 65536, (5, 7), np.uint16)


@pytest.mark.parametrize("encoding", ["mono8", "8UC1"])
def test_grey_of_8_bit_is_as_it_is(encoding: str) -> None:
    rows = np.full((5, 10), 99, np.uint8)
    rows[:, :7] = BGR[..., 0]
    for big in (False, True):
        image = raw_image(encoding, 7, 5, 10, big, memoryview(rows.tobytes()))
        np.testing.assert_array_equal(image, BGR[..., 0])


@pytest.mark.parametrize("encoding", ["mono16", "16UC1"])
@pytest.mark.parametrize("big", [False, True])
@pytest.mark.parametrize("padding", [0, 3, 4])
def test_grey_of_16_bit_in_either_byte_order(encoding: str, big: bool, padding: int) -> None:
    rows = np.full((5, 14 + padding), 99, np.uint8)
    rows[:, :14] = DEEP.astype(">u2" if big else "<u2").view(np.uint8)
    image = raw_image(encoding, 7, 5, 14 + padding, big, memoryview(rows.tobytes()))
    np.testing.assert_allclose(image, DEEP / 257, rtol=1e-6)


@pytest.mark.parametrize(
    ("encoding", "pixels"),
    [
        ("bgr8", BGR),
        ("rgb8", BGR[..., ::-1]),
        ("bgra8", cv2.cvtColor(BGR, cv2.COLOR_BGR2BGRA)),
        ("rgba8", cv2.cvtColor(BGR, cv2.COLOR_BGR2RGBA)),
    ],
)
def test_colour_is_its_luminance(encoding: str, pixels: np.ndarray) -> None:
    channels = pixels.shape[2]
    image = raw_image(encoding, 7, 5, 7 * channels, False, memoryview(pixels.tobytes()))
    np.testing.assert_array_equal(image, luminance(BGR))


@pytest.mark.parametrize("said", ["jpeg", "bgr8; jpeg compressed bgr8", "png", ""])
def test_compressed_images_say_themselves_what_they_are(said: str) -> None:
    png = memoryview(cv2.imencode(".png", BGR)[1].tobytes())
    np.testing.assert_array_equal(compressed_image(said, png), luminance(BGR))
    grey = np.full((16, 24), 77, np.uint8)
    jpeg = memoryview(cv2.imencode(".jpg", grey)[1].tobytes())
    np.testing.assert_allclose(compressed_image(said, jpeg), grey, atol=2)


def test_a_compressed_image_of_16_bit() -> None:
    png = memoryview(cv2.imencode(".png", DEEP)[1].tobytes())
    np.testing.assert_allclose(compressed_image("mono16; png compressed ", png), DEEP / 257, rtol=1e-6)


@pytest.mark.parametrize(
    ("encoding", "width", "height", "step", "size", "word"),
    [
        ("bayer_rggb8", 7, 5, 7, 35, "'bayer_rggb8': publish it in one of mono8"),
        ("32FC1", 7, 5, 28, 140, "32FC1"),
        ("x" * 1000, 7, 5, 7, 35, "publish it in one of"),
        ("mono8", 0, 5, 7, 35, "0 x 5"),
        ("mono8", 7, 0, 7, 0, "7 x 0"),
        ("mono8", 7, 5, 6, 30, "row of 7 pixels"),
        ("mono8", 7, 5, 0, 0, "row of 7 pixels"),
        ("mono8", 7, 5, 7, 34, "34 bytes"),
        ("mono8", 7, 5, 7, 36, "36 bytes"),
        ("mono16", 7, 5, 7, 35, "row of 7 pixels"),
        ("mono8", 2**32 - 1, 2**32 - 1, 2**32 - 1, 35, "too many"),
        ("mono8", 16384, 16384, 16384, 35, "too many"),
    ],
)
def test_what_is_refused(encoding: str, width: int, height: int, step: int, size: int, word: str) -> None:
    with pytest.raises(PacketError, match=word) as caught:
        raw_image(encoding, width, height, step, False, memoryview(bytes(size)))
    assert len(str(caught.value)) < 300
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("data", [b"", b"\0" * 100, b"\xff\xd8", b"\x89PNG\r\n\x1a\n", b"GIF89a"])
def test_compressed_images_that_are_none(data: bytes) -> None:
    with pytest.raises(PacketError, match="no "):
        compressed_image("jpeg", memoryview(data))


def test_depth_with_its_own_header_is_refused() -> None:
    png = cv2.imencode(".png", DEEP)[1].tobytes()
    with pytest.raises(PacketError, match="'16UC1; compressedDepth' is no JPEG or PNG"):
        compressed_image("16UC1; compressedDepth", memoryview(bytes(12) + png))


@given(
    st.sampled_from([*ENCODINGS, *ALIASES, "yuv422"]),
    st.integers(0, 40),
    st.integers(0, 40),
    st.integers(0, 400),
    st.booleans(),
    st.binary(max_size=2000),
)
def test_any_fields_give_an_image_or_a_word(
    encoding: str, width: int, height: int, step: int, big: bool, data: bytes
) -> None:
    try:
        image = raw_image(encoding, width, height, step, big, memoryview(data))
    except PacketError:
        return
    assert image.shape == (height, width)
    assert len(data) == height * step
