"""`.bag`, `.mcap`, `.db3` and ROS 2 bag folders, read with rosbags: no ROS needed.

Events: dvs_msgs/EventArray and prophesee_event_msgs/EventArray, which are laid out alike, and
event_camera_msgs/EventPacket in the encodings of voltcam_client.encodings. Frames: sensor_msgs/Image, 8 bit.
Of several cameras, the one with the most event messages is read, and the images whose topic starts most like
it.

Sources: those of `ros_messages`; prophesee_ros_wrapper.
"""

import os.path
from pathlib import Path
from typing import Any

import numpy as np

from voltcam_client.encodings import ENCODINGS, Events
from voltcam_client.formats.library import grey, library, named, stacked
from voltcam_client.formats.recording import FormatError, Recording, smallest_size
from voltcam_client.formats.ros_messages import (
    ARRAY,
    IMAGE,
    PACKET,
    from_cdr_array,
    from_ros1_array,
    register,
)

KINDS = {".bag": "ROS 1 bag", ".mcap": "ROS 2 bag, MCAP", ".db3": "ROS 2 bag, SQLite"}
"""What can be read and written, by suffix."""

METADATA = "metadata.yaml"  # in a ROS 2 bag folder

_ARRAYS = (ARRAY, "prophesee_event_msgs/msg/EventArray")
_CHANNELS = {
    "mono8": "",
    "8UC1": "",
    "rgb8": "RGB",
    "bgr8": "BGR",
    "rgba8": "RGBA",
    "bgra8": "BGRA",
    "8UC3": "BGR",
}


def read_bag(path: Path) -> Recording:
    """Read the events and frames of one camera; FormatError where the bag has no topic of events."""
    highlevel = library("rosbags.highlevel", path)
    with (
        named(path, "ROS bag"),
        highlevel.AnyReader([path], default_typestore=_typestore(path)) as bag,
    ):
        source, images = _topics(path, bag.connections)
        if source.msgtype == PACKET:
            events, size = _packets(path, bag, source)
        else:
            events, size = _arrays(bag, source)
        events = events[np.argsort(events["t"], kind="stable")]  # messages may come late
        width, height = size if size[0] and size[1] else smallest_size(events)
        if images is None:
            return Recording(events, width, height)
        stamped = sorted(_images(path, bag, images), key=lambda frame: frame[0])
        t_us = np.array([t for t, _ in stamped], np.int64)
        return Recording(events, width, height, stacked([image for _, image in stamped], path), t_us)


def _typestore(path: Path) -> Any:
    typesys = library("rosbags.typesys", path)
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    register(store, typesys)  # for old ROS 2 bags, which do not say how their messages are laid out
    return store


def _topics(path: Path, connections: Any) -> tuple[Any, Any | None]:
    """The connection of events, and of images if any."""
    filled = sorted((c for c in connections if c.msgcount), key=lambda c: (-c.msgcount, c.topic))
    events = [c for c in filled if c.msgtype in (*_ARRAYS, PACKET)]
    if not events:
        there = ", ".join(sorted({f"{c.topic} ({c.msgtype})" for c in connections})) or "nothing"
        raise FormatError(f"{path} has no topic of events, only {there}: record {_ARRAYS[0]} or {PACKET}")

    def shared_name(connection: Any) -> int:
        return len(os.path.commonpath([f"/{c.topic.strip('/')}" for c in (connection, events[0])]))

    images = (c for c in filled if c.msgtype == IMAGE)
    return events[0], max(images, key=shared_name, default=None)


def _arrays(bag: Any, source: Any) -> tuple[Events, tuple[int, int]]:
    parts: list[Events] = []
    size = (0, 0)
    for _, _, raw in bag.messages([source]):
        part, size = from_cdr_array(raw) if bag.is2 else from_ros1_array(raw)
        parts.append(part)
    return np.concatenate(parts), size


def _packets(path: Path, bag: Any, source: Any) -> tuple[Events, tuple[int, int]]:
    parts: list[Events] = []
    words = b""  # of a sensor's own clock, which runs on through the packets
    stamp_us = 0
    size = (0, 0)
    for _, log_ns, raw in bag.messages([source]):
        packet = bag.deserialize(raw, PACKET)
        size = (packet.width, packet.height)
        if packet.encoding not in ENCODINGS:
            known = ", ".join(ENCODINGS)
            raise FormatError(f"{path}: its events are in {packet.encoding!r}: record them in {known}")
        if packet.encoding == "evt3" and packet.time_base == 0:
            stamp_us = stamp_us or _stamp_us(packet, log_ns)
            words += packet.events.tobytes()
        else:
            decode = ENCODINGS[packet.encoding].decode
            parts.append(decode(packet.events.tobytes(), packet.time_base // 1000))
    if words:
        # Drivers of Prophesee's leave time_base at 0; only the first packet's stamp tells of ROS's clock.
        events = ENCODINGS["evt3"].decode(words, 0)
        events["t"] += stamp_us - (int(events["t"][0]) if events.size else 0)
        parts.append(events)
    return np.concatenate(parts), size


def _images(path: Path, bag: Any, connection: Any) -> Any:
    """Times in us and images (H, W)."""
    for _, log_ns, raw in bag.messages([connection]):
        message = bag.deserialize(raw, IMAGE)
        if message.encoding not in _CHANNELS:
            raise FormatError(
                f"{path}: {connection.topic} is in {message.encoding!r}: record {', '.join(_CHANNELS)}"
            )
        channels = _CHANNELS[message.encoding]
        depth = len(channels) or 1
        rows = message.data.reshape(message.height, message.step)[:, : message.width * depth]
        image = rows.reshape(message.height, message.width, depth)
        yield _stamp_us(message, log_ns), grey(image, channels) if channels else image[..., 0]


def _stamp_us(message: Any, log_ns: int) -> int:
    stamp = message.header.stamp
    return (stamp.sec * 10**9 + stamp.nanosec or log_ns) // 1000
