"""Images that programs send: raw in all layouts, JPEG and PNG, whole or refused."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from voltcam_client.errors import PacketError
from voltcam_client.pushed_frame import ENCODINGS, FrameHeader
from voltcam_video import luminance
from voltcam_video.sources.pushed_image import image_of, size_of

RNG = np.random.default_rng(1)
BGR = RNG.integers(0, 256, (5, 7, 3), np.uint8)


def header(
    encoding: str, width: int | None = 7, height: int | None = 5, step: int | None = None
) -> FrameHeader:
    return FrameHeader(t_us=0, encoding=encoding, width=width, height=height, step=step)


def as_sent(encoding: str, deep: bool) -> NDArray[np.generic]:
    """BGR in a layout, of 16 bit with the same in the upper byte."""
    pixels = BGR.astype(np.uint16) * 257 if deep else BGR
    order = {"B": pixels[..., 0], "G": pixels[..., 1], "R": pixels[..., 2], "A": pixels[..., 0]}
    return np.stack([order[channel] for channel in ENCODINGS[encoding].channels], axis=-1)


@pytest.mark.parametrize("encoding", [name for name in ENCODINGS if not name.startswith("mono")])
def test_colour_in_any_order_is_one_luminance(encoding: str) -> None:
    data = as_sent(encoding, encoding.endswith("16")).tobytes()
    said = header(encoding)
    assert size_of(said, memoryview(data)) == (7, 5)
    np.testing.assert_allclose(image_of(said, memoryview(data)), luminance(BGR), atol=0.6)


def test_grey_is_as_it_is_and_an_own_copy() -> None:
    data = memoryview(bytes(range(35)))
    image = image_of(header("mono8"), data)
    np.testing.assert_array_equal(image, np.arange(35).reshape(5, 7))
    assert image.flags.writeable
    deep = np.arange(35, dtype="<u2") * 257
    np.testing.assert_allclose(
        image_of(header("mono16"), memoryview(deep.tobytes())).ravel(), range(35), atol=0.01
    )


def test_rows_may_be_padded() -> None:
    rows = np.full((5, 10), 99, np.uint8)
    rows[:, :7] = np.arange(35).reshape(5, 7)
    padded = header("mono8", step=10)
    assert size_of(padded, memoryview(rows.tobytes())) == (7, 5)
    np.testing.assert_array_equal(image_of(padded, memoryview(rows.tobytes())), rows[:, :7])


@pytest.mark.parametrize("kind", ["png", "jpeg"])
def test_files_say_their_size_themselves(kind: str) -> None:
    file = memoryview(cv2.imencode(".jpg" if kind == "jpeg" else ".png", BGR)[1].tobytes())
    said = header(kind, None, None)
    assert size_of(said, file) == (7, 5)
    np.testing.assert_allclose(image_of(said, file), luminance(BGR), atol=0 if kind == "png" else 60)
    with pytest.raises(PacketError, match="the header says 8 x 5, the image is 7 x 5"):
        size_of(header(kind, 8, 5), file)
    with pytest.raises(PacketError, match=f"no whole {kind}"):
        size_of(said, file[:-20])


def test_a_file_that_claims_too_much_is_refused_before_it_is_decoded() -> None:
    file = bytearray(cv2.imencode(".png", BGR)[1].tobytes())
    file[16:24] = (60_000).to_bytes(4, "big") * 2
    with pytest.raises(PacketError, match="too many"):
        size_of(header("png", None, None), memoryview(bytes(file)))


@pytest.mark.parametrize("at", [8, 33])
@pytest.mark.parametrize("length", [0, 14, 0x7FFFFFFF, 0xC6000000])
def test_a_chunk_that_says_more_than_there_is_is_refused_before_it_is_decoded(at: int, length: int) -> None:
    """OpenCV takes 3 GB and 10 s for some such file of 90 bytes."""
    file = bytearray(cv2.imencode(".png", BGR)[1].tobytes())
    file[at : at + 4] = length.to_bytes(4, "big")
    with pytest.raises(PacketError, match="no whole png"):
        size_of(header("png", None, None), memoryview(bytes(file)))


@pytest.mark.parametrize(("size", "step"), [(34, None), (36, None), (35, 6), (49, 10)])
def test_bytes_that_are_no_such_rows(size: int, step: int | None) -> None:
    with pytest.raises(PacketError, match=r"rows|row of"):
        size_of(header("mono8", step=step), memoryview(bytes(size)))


@given(st.binary(max_size=200), st.sampled_from(["png", "jpeg"]), st.booleans())
def test_any_bytes_are_an_image_or_one_line(data: bytes, kind: str, begins_well: bool) -> None:
    if begins_well:
        data = (b"\x89PNG\r\n\x1a\n" if kind == "png" else b"\xff\xd8") + data
    line = ""
    try:
        size_of(header(kind, None, None), memoryview(data))
        image_of(header(kind, None, None), memoryview(data))
    except PacketError as error:
        line = str(error)
    assert "\n" not in line
