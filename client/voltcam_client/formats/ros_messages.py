"""Messages of events in ROS 1 and in CDR, by hand where a library would go event by event: 100 times as fast.

Sources: rpg_dvs_ros, ros-event-camera/event_camera_msgs; wiki.ros.org/msg; OMG DDS-XTypes (CDR).
"""

import struct
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import EVENT, Events

ARRAY = "dvs_msgs/msg/EventArray"
PACKET = "event_camera_msgs/msg/EventPacket"
IMAGE = "sensor_msgs/msg/Image"

EventsAs = Literal["packet", "array"]
"""Which of the two is published."""

DEFINITIONS = {
    PACKET: "std_msgs/Header header\nuint32 height\nuint32 width\nuint64 seq\nuint64 time_base\n"
    "string encoding\nbool is_bigendian\nuint8[] events",
    "dvs_msgs/msg/Event": "uint16 x\nuint16 y\nbuiltin_interfaces/Time ts\nbool polarity",
    ARRAY: "std_msgs/Header header\nuint32 height\nuint32 width\ndvs_msgs/Event[] events",
}
"""The fields of messages that a ROS installation may lack, as ROS 2 writes them."""

# An event as ROS 1 packs it, and as CDR aligns it from the second one on.
_ROS1_EVENT = np.dtype([("x", "<u2"), ("y", "<u2"), ("s", "<u4"), ("ns", "<u4"), ("p", "u1")])
_CDR_EVENT = np.dtype(
    [("x", "<u2"), ("y", "<u2"), ("_", "<u2"), ("s", "<u4"), ("ns", "<u4"), ("p", "u1"), ("__", "u1")]
)


def register(store: Any, typesys: Any) -> None:
    """Make the messages of events known to a rosbags typestore."""
    for name, fields in DEFINITIONS.items():
        if name not in store.types:
            store.register(typesys.get_types_from_msg(fields, name))


def from_ros1_array(raw: bytes) -> tuple[Events, tuple[int, int]]:
    """Events, width and height of seq, stamp (12 bytes), frame_id, height, width, count, events."""
    start = 16 + int.from_bytes(raw[12:16], "little")
    height, width, count = np.frombuffer(raw, "<u4", 3, start).tolist()
    return _as_events(np.frombuffer(raw, _ROS1_EVENT, count, start + 12)), (width, height)


def ros1_header(t_us: int, sequence: int, frame_id: str) -> bytes:
    """std_msgs/Header. Raises ValueError for a time that ROS 1 has not."""
    if not 0 <= t_us < 1_000_000 << 32:
        raise ValueError(f"the stamp is {t_us} us: ROS 1 has no times after 2^32 s")
    name = frame_id.encode()
    return struct.pack("<IIII", sequence, *_seconds(t_us), len(name)) + name


def ros1_array(
    events: Events, t_us: int, sequence: int, frame_id: str, width: int, height: int
) -> memoryview:
    """The same the other way, stamped `t_us`."""
    head = ros1_header(t_us, sequence, frame_id) + struct.pack("<III", height, width, events.size)
    return memoryview(head + _as_rows(events, _ROS1_EVENT).tobytes())


def from_cdr_array(raw: bytes) -> tuple[Events, tuple[int, int]]:
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


def cdr_array(events: Events, t_us: int, sequence: int, frame_id: str, width: int, height: int) -> memoryview:
    """The same the other way, stamped `t_us`; ROS 2 has no `sequence`."""
    name = frame_id.encode() + b"\0"
    head = struct.pack("<III", *_seconds(t_us), len(name)) + name
    head += bytes(-len(head) % 4) + struct.pack("<III", height, width, events.size)
    rows = bytearray(_as_rows(events, _CDR_EVENT).tobytes())
    rows[2:6] = rows[0:4]  # the first event's x and y
    return memoryview(b"\0\1\0\0" + head + bytes(rows[2:-1]))


def _seconds(t_us: int) -> tuple[int, int]:
    """Seconds and nanoseconds."""
    return t_us // 1_000_000, t_us % 1_000_000 * 1000


def _as_events(rows: NDArray[np.void]) -> Events:
    events = np.empty(rows.size, EVENT)
    events["t"] = rows["s"].astype(np.int64) * 1_000_000 + rows["ns"] // 1000
    events["x"], events["y"], events["p"] = rows["x"], rows["y"], rows["p"]
    return events


def _as_rows(events: Events, kind: np.dtype[Any]) -> NDArray[np.void]:
    rows = np.zeros(events.size, kind)
    rows["s"], us = np.divmod(events["t"], 1_000_000)
    rows["ns"] = us * 1000
    rows["x"], rows["y"], rows["p"] = events["x"], events["y"], events["p"]
    return rows
