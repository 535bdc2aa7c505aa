"""`.bag`, `.mcap`, `.db3` and ROS 2 bag folders, read with rosbags: no ROS needed.

Events: dvs_msgs/EventArray and prophesee_event_msgs/EventArray, which are laid out alike, and
event_camera_msgs/EventPacket in the encodings of voltcam_client.encodings. Frames: sensor_msgs/Image, 8 bit.
Of several cameras, the one with the most event messages is read, and the images whose topic starts most like
it.

Sources: rpg_dvs_ros, prophesee_ros_wrapper, ros-event-camera/event_camera_msgs; wiki.ros.org/msg; OMG
DDS-XTypes (CDR).
"""

import os.path
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import ENCODINGS, EVENT, Events
from voltcam_client.formats.library import grey, library, named, stacked
from voltcam_client.formats.recording import FormatError, Recording, smallest_size

DESCRIPTION = "ROS bag of dvs_msgs, prophesee_event_msgs or event_camera_msgs, and 8-bit sensor_msgs/Image"
METADATA = "metadata.yaml"  # in a ROS 2 bag folder

_ARRAYS = ("dvs_msgs/msg/EventArray", "prophesee_event_msgs/msg/EventArray")
_PACKET = "event_camera_msgs/msg/EventPacket"
_IMAGE = "sensor_msgs/msg/Image"
_CHANNELS = {
    "mono8": "",
    "8UC1": "",
    "rgb8": "RGB",
    "bgr8": "BGR",
    "rgba8": "RGBA",
    "bgra8": "BGRA",
    "8UC3": "BGR",
}

# For old ROS 2 bags, which do not say how their messages are laid out.
_PACKET_FIELDS = """std_msgs/Header header
uint32 height
uint32 width
uint64 seq
uint64 time_base
string encoding
bool is_bigendian
uint8[] events"""

# An event as ROS 1 packs it, and as CDR aligns it from the second one on.
_ROS1_EVENT = np.dtype([("x", "<u2"), ("y", "<u2"), ("s", "<u4"), ("ns", "<u4"), ("p", "u1")])
_CDR_EVENT = np.dtype(
    [("x", "<u2"), ("y", "<u2"), ("_", "<u2"), ("s", "<u4"), ("ns", "<u4"), ("p", "u1"), ("__", "u1")]
)


def read_bag(path: Path) -> Recording:
    """Read the events and frames of one camera; FormatError where the bag has no topic of events."""
    highlevel = library("rosbags.highlevel", path)
    with (
        named(path, "ROS bag"),
        highlevel.AnyReader([path], default_typestore=_typestore(path)) as bag,
    ):
        source, images = _topics(path, bag.connections)
        if source.msgtype == _PACKET:
            events, size = _packets(path, bag, source)
        else:
            events, size = _arrays(bag, source)
        events.sort(order="t", kind="stable")  # messages may come late
        width, height = size if size[0] and size[1] else smallest_size(events)
        if images is None:
            return Recording(events, width, height)
        stamped = sorted(_images(path, bag, images), key=lambda frame: frame[0])
        t_us = np.array([t for t, _ in stamped], np.int64)
        return Recording(events, width, height, stacked([image for _, image in stamped], path), t_us)


def _typestore(path: Path) -> Any:
    typesys = library("rosbags.typesys", path)
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    store.register(typesys.get_types_from_msg(_PACKET_FIELDS, _PACKET))
    return store


def _topics(path: Path, connections: Any) -> tuple[Any, Any | None]:
    """The connection of events, and of images if any."""
    filled = sorted((c for c in connections if c.msgcount), key=lambda c: (-c.msgcount, c.topic))
    events = [c for c in filled if c.msgtype in (*_ARRAYS, _PACKET)]
    if not events:
        there = ", ".join(sorted({f"{c.topic} ({c.msgtype})" for c in connections})) or "nothing"
        raise FormatError(f"{path} has no topic of events, only {there}: record {_ARRAYS[0]} or {_PACKET}")

    def shared_name(connection: Any) -> int:
        return len(os.path.commonpath([f"/{c.topic.strip('/')}" for c in (connection, events[0])]))

    images = (c for c in filled if c.msgtype == _IMAGE)
    return events[0], max(images, key=shared_name, default=None)


def _arrays(bag: Any, source: Any) -> tuple[Events, tuple[int, int]]:
    parts: list[Events] = []
    size = (0, 0)
    for _, _, raw in bag.messages([source]):
        part, size = _cdr_array(raw) if bag.is2 else _ros1_array(raw)
        parts.append(part)
    return np.concatenate(parts), size


def _ros1_array(raw: bytes) -> tuple[Events, tuple[int, int]]:
    """seq, stamp (12 bytes), frame_id, height, width, count, events. Read by hand: 100 times as fast."""
    start = 16 + int.from_bytes(raw[12:16], "little")
    height, width, count = np.frombuffer(raw, "<u4", 3, start).tolist()
    return _as_events(np.frombuffer(raw, _ROS1_EVENT, count, start + 12)), (width, height)


def _cdr_array(raw: bytes) -> tuple[Events, tuple[int, int]]:
    """The same in CDR: 4 bytes of encapsulation, then every number on a multiple of its size.

    An event starts two bytes after the one before ended, on an odd half word, so that its stamp is aligned;
    but the first one starts on a whole one.
    """
    if raw[1] != 1:
        raise ValueError("big-endian CDR")
    body = bytes(raw[4:])
    start = -(-(12 + int.from_bytes(body[8:12], "little")) // 4) * 4
    height, width, count = np.frombuffer(body, "<u4", 3, start).tolist()
    first = start + 12
    rows = np.frombuffer(body[first - 2 :] + b"\0\0", _CDR_EVENT, count).copy()
    if count:
        rows["x"][0], rows["y"][0] = np.frombuffer(body, "<u2", 2, first)
    return _as_events(rows), (width, height)


def _as_events(rows: NDArray[np.void]) -> Events:
    events = np.empty(rows.size, EVENT)
    events["t"] = rows["s"].astype(np.int64) * 1_000_000 + rows["ns"] // 1000
    events["x"], events["y"], events["p"] = rows["x"], rows["y"], rows["p"]
    return events


def _packets(path: Path, bag: Any, source: Any) -> tuple[Events, tuple[int, int]]:
    parts: list[Events] = []
    words = b""  # of a sensor's own clock, which runs on through the packets
    stamp_us = 0
    size = (0, 0)
    for _, log_ns, raw in bag.messages([source]):
        packet = bag.deserialize(raw, _PACKET)
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
        message = bag.deserialize(raw, _IMAGE)
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
