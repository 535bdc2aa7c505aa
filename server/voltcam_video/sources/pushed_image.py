"""The image of a frame that a program sends: from its bytes to luminance, nothing believed unseen."""

import numpy as np

from voltcam_client.errors import PacketError
from voltcam_client.pushed_frame import ENCODINGS, FrameHeader, PixelLayout, check_size
from voltcam_video.frame import Image, luminance
from voltcam_video.opencv import cv2

PNG_BEGIN, PNG_END = b"\x89PNG\r\n\x1a\n", b"IEND\xaeB`\x82"
JPEG_BEGIN, JPEG_END = b"\xff\xd8", b"\xff\xd9"
# Start of frame, ITU-T T.81 table B.1: all of FFC0 to FFCF that do not define tables or are reserved.
JPEG_SIZES = frozenset({*range(0xC0, 0xD0)} - {0xC4, 0xC8, 0xCC})


def size_of(header: FrameHeader, data: memoryview) -> tuple[int, int]:
    """(width, height). Raises PacketError where the bytes are none of such an image."""
    if header.encoding in ENCODINGS:
        assert header.width is not None
        assert header.height is not None
        check_rows(header.encoding, header.width, header.height, header.step, len(data))
        return header.width, header.height
    size = _png_size(data) if header.encoding == "png" else _jpeg_size(data)
    said = header.width or size[0], header.height or size[1]
    if said != size:
        raise PacketError(f"the header says {said[0]} x {said[1]}, the image is {size[0]} x {size[1]}")
    check_size(*size)
    return size


def image_of(header: FrameHeader, data: memoryview) -> Image:
    """The luminance of an image whose `size_of` is known. Raises PacketError."""
    if header.encoding in ENCODINGS:
        width, height = header.width or 0, header.height or 0
        return image_of_rows(ENCODINGS[header.encoding], width, height, header.step, data)
    try:
        image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:  # of some damage only; of most it gives none
        image = None
    if image is None:
        raise PacketError(f"{len(data)} bytes are no whole {header.encoding} image")
    try:
        return luminance(image)
    except ValueError as error:
        raise PacketError(f"{header.encoding}: {error}") from None


def image_of_rows(layout: PixelLayout, width: int, height: int, step: int | None, data: memoryview) -> Image:
    """The luminance of a raw image, of either byte order, whose rows `check_rows` has seen."""
    dtype, channels = np.dtype(layout.dtype), len(layout.channels)
    row = width * channels * dtype.itemsize
    rows = np.frombuffer(data, np.uint8).reshape(height, step or row)[:, :row]
    pixels = np.ascontiguousarray(rows).view(dtype).reshape(height, width, channels)
    if channels > 1:
        pixels = pixels[..., [layout.channels.index(channel) for channel in "BGR"]]
    image = luminance(pixels.astype(dtype.newbyteorder("="), copy=False))
    return image if image.flags.writeable else image.copy()  # the message is given back


def check_rows(encoding: str, width: int, height: int, step: int | None, size: int) -> None:
    """Raises PacketError where so many bytes are no such rows. step: of bytes; None: rows are not padded."""
    layout = ENCODINGS[encoding]
    row = width * len(layout.channels) * np.dtype(layout.dtype).itemsize
    step = row if step is None else step
    if step < row:
        raise PacketError(f"step is {step}, but a row of {width} pixels {encoding} has {row} bytes")
    if size != height * step:
        raise PacketError(f"{size} bytes are no {height} rows of {step} bytes, {width} pixels {encoding}")


def _png_size(data: memoryview) -> tuple[int, int]:
    """The header chunk is the first, at a fixed place (PNG, third edition, 11.2.1)."""
    whole = data[:8] == PNG_BEGIN and bytes(data[12:16]) == b"IHDR" and data[-8:] == PNG_END
    if not (whole and _chunks_fit(data)):
        raise PacketError(f"{len(data)} bytes are no whole png image")
    return _sane(int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big"), "png")


def _chunks_fit(data: memoryview) -> bool:
    """Whether the chunks of a PNG end where the bytes do: OpenCV takes memory for what a chunk says it has.

    Of a chunk: u32 length, type, so many bytes, check sum (PNG, third edition, 5.3).
    """
    at = len(PNG_BEGIN)
    while at < len(data):
        at += 12 + int.from_bytes(data[at : at + 4], "big")
    return at == len(data)


def _jpeg_size(data: memoryview) -> tuple[int, int]:
    """Of the first start of frame: segments of a marker, u16 length, content (ITU-T T.81, B.1.1.4)."""
    if data[:2] != JPEG_BEGIN or bytes(data[-64:]).rstrip(b"\0")[-2:] != JPEG_END:
        raise PacketError(f"{len(data)} bytes are no whole jpeg image")
    at = 2
    while at + 9 <= len(data) and data[at] == 0xFF:
        marker, length = data[at + 1], int.from_bytes(data[at + 2 : at + 4], "big")
        if marker in JPEG_SIZES:
            height, width = (int.from_bytes(data[at + i : at + i + 2], "big") for i in (5, 7))
            return _sane(width, height, "jpeg")
        at += 1 if marker == 0xFF else 2 + max(2, length)  # markers may be filled up
    raise PacketError(f"{len(data)} bytes are no whole jpeg image")


def _sane(width: int, height: int, encoding: str) -> tuple[int, int]:
    if not (width and height):
        raise PacketError(f"the {encoding} image has {width} x {height} pixels")
    return width, height
