"""The image of a message of ROS: sensor_msgs/Image and CompressedImage, from their fields to luminance.

Sources: sensor_msgs/image_encodings.hpp; image_transport_plugins (compressed_image_transport).
"""

from voltcam_client.errors import PacketError
from voltcam_client.pushed_frame import ENCODINGS, FrameHeader, check_size
from voltcam_video.frame import Image
from voltcam_video.sources.pushed_image import (
    JPEG_BEGIN,
    PNG_BEGIN,
    check_rows,
    image_of,
    image_of_rows,
    size_of,
)

ALIASES = {"8UC1": "mono8", "16UC1": "mono16"}
"""Encodings that say how many bits there are, and not what they are: read as grey."""


def raw_image(
    encoding: str, width: int, height: int, step: int, is_bigendian: bool, data: memoryview
) -> Image:
    """Of sensor_msgs/Image. Raises PacketError for what is none, or in an encoding that is not read."""
    name = ALIASES.get(encoding, encoding)
    if name not in ENCODINGS:
        known = ", ".join((*ENCODINGS, *ALIASES))
        raise PacketError(f"an image in {encoding[:40]!r}: publish it in one of {known}")
    if not (width and height):
        raise PacketError(f"an image of {width} x {height} pixels: publish one that has some")
    check_size(width, height)
    check_rows(name, width, height, step, len(data))
    layout = ENCODINGS[name]
    if is_bigendian:
        layout = layout._replace(dtype=layout.dtype.replace("<", ">"))
    return image_of_rows(layout, width, height, step, data)


def compressed_image(encoding: str, data: memoryview) -> Image:
    """Of sensor_msgs/CompressedImage: JPEG or PNG, as the bytes begin. encoding: its `format`.

    Raises PacketError. Colours are those of the file, whatever `format` says of their order before.
    """
    kinds = {"jpeg": JPEG_BEGIN, "png": PNG_BEGIN}
    kind = next((kind for kind, begin in kinds.items() if data[: len(begin)] == begin), None)
    if kind is None:
        raise PacketError(f"a compressed image in {encoding[:40]!r} is no JPEG or PNG: publish one of these")
    header = FrameHeader(t_us=0, encoding=kind)
    size_of(header, data)
    return image_of(header, data)
