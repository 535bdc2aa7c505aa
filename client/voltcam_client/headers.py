"""The msgpack headers of messages, as far as all topics share them."""

from collections.abc import Mapping
from typing import Any, cast

import msgpack

from voltcam_client.encodings import Buffer
from voltcam_client.errors import PacketError


def ros_header(stamp_ns: int, frame_id: str) -> dict[str, Any]:
    """As std_msgs/Header of ROS."""
    sec, nanosec = divmod(stamp_ns, 1_000_000_000)
    return {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": frame_id}


def stamp_ns_of(header: Mapping[str, Any]) -> int:
    """The host's clock in a message's header."""
    stamp = header["header"]["stamp"]
    return int(stamp["sec"] * 1_000_000_000 + stamp["nanosec"])


def pack_header(header: dict[str, Any]) -> bytes:
    """The bytes of a header."""
    return cast(bytes, msgpack.packb(header))


def unpack_header(header_bytes: Buffer) -> dict[str, Any]:
    """A header of its bytes. Raises PacketError."""
    try:
        header = msgpack.unpackb(header_bytes)
    except (ValueError, msgpack.UnpackException) as error:
        raise PacketError("the header is not msgpack; is it a Voltcam daemon?") from error
    if not isinstance(header, dict):
        raise PacketError("the header is not a map; is it a Voltcam daemon?")
    return header
