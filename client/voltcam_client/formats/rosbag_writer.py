"""`.bag` (ROS 1), `.mcap` and `.db3` (ROS 2), written with rosbags: no ROS needed.

/dvs/events     event_camera_msgs/EventPacket in the encoding libcaer, as a DAVIS's driver sends it; in
                `.dvs.bag`, `.dvs.mcap` and `.dvs.db3` dvs_msgs/EventArray
/dvs/image_raw  sensor_msgs/Image, mono8

A message holds the events of at most 10 ms. A bag without its index, which comes last, is none to most
readers, so a recording is spooled, and put together on close.

Sources: those of `rosbag`; ros-event-camera/libcaer_driver; rpg_dvs_ros.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import Events, encode_libcaer
from voltcam_client.formats.library import library
from voltcam_client.formats.recording import Recording
from voltcam_client.formats.ros_messages import (
    ARRAY,
    IMAGE,
    PACKET,
    cdr_array,
    register,
    ros1_array,
)
from voltcam_client.formats.spool import blocks
from voltcam_client.formats.spooled import SpooledWriter

MESSAGES = {
    "": "event_camera_msgs/EventPacket and sensor_msgs/Image",
    ".dvs": "dvs_msgs/EventArray and sensor_msgs/Image",
}
"""What is in a bag, by what is before its suffix."""

EVENTS_TOPIC, IMAGE_TOPIC, FRAME_ID = "/dvs/events", "/dvs/image_raw", "dvs"
MESSAGE_US = 10_000
_LAST_US = {True: 1 << 32, False: 1 << 31}  # ROS 1: its seconds are unsigned; ROS 2: they are not


class BagWriter(SpooledWriter):
    """Spools, and makes the bag on close."""

    def __init__(self, path: Path, width: int, height: int, *, overwrite: bool = False) -> None:
        library("rosbags.highlevel", path, "writing")
        super().__init__(path, width, height, overwrite=overwrite)

    def _check_span(self, events: Events) -> None:
        ros1 = self.path.suffix.lower() == ".bag"
        if events.size and events["t"][-1] >= _LAST_US[ros1] * 1_000_000:
            raise ValueError(f"{self.path}: ROS has no times after 2^31 s (ROS 1: 2^32 s): choose .npz")

    def _assemble(self, recording: Recording, path: Path) -> None:
        arrays = self.path.stem.lower().endswith(".dvs")
        with TemporaryDirectory(dir=path.parent) as folder:
            bag = _Bag(path.suffix.lower(), Path(folder) / "bag")
            with bag.writer:
                messages = _Messages(bag, recording.width, recording.height)
                write_events = messages.event_array if arrays else messages.event_packet
                for write, t_us, content in _in_order(recording, write_events, messages.image):
                    write(t_us, content)
            bag.file().replace(path)


class _Bag:
    """A bag of the suffix's kind that is being made, and the layout of its messages."""

    def __init__(self, suffix: str, path: Path) -> None:
        self.ros1 = suffix == ".bag"
        self.path = path
        typesys = library("rosbags.typesys", path)
        self.store = typesys.get_typestore(
            typesys.Stores.ROS1_NOETIC if self.ros1 else typesys.Stores.ROS2_HUMBLE
        )
        register(self.store, typesys)
        if self.ros1:
            self.writer: Any = library("rosbags.rosbag1", path).Writer(path)
        else:
            rosbag2 = library("rosbags.rosbag2", path)
            plugin = rosbag2.StoragePlugin.MCAP if suffix == ".mcap" else rosbag2.StoragePlugin.SQLITE3
            self.writer = rosbag2.Writer(path, version=9, storage_plugin=plugin)

    def file(self) -> Path:
        """The one file of the bag; ROS 2 has it in a folder."""
        return self.path if self.ros1 else next(self.path.glob("bag.*"))


class _Messages:
    """Writes messages into an open bag."""

    def __init__(self, bag: _Bag, width: int, height: int) -> None:
        self._bag, self._store, self._width, self._height = bag, bag.store, width, height
        self._serialize = bag.store.serialize_ros1 if bag.ros1 else bag.store.serialize_cdr
        self._connections: dict[str, Any] = {}
        self._counts: dict[str, int] = {}

    def event_packet(self, t_us: int, events: Events) -> None:
        message = self._store.types[PACKET](
            header=self._header(EVENTS_TOPIC, t_us),
            height=self._height,
            width=self._width,
            seq=self._counts.get(EVENTS_TOPIC, 0),
            time_base=1000 * t_us,
            encoding="libcaer",
            is_bigendian=False,
            events=np.frombuffer(encode_libcaer(events, t_us), np.uint8),
        )
        self._write(EVENTS_TOPIC, PACKET, t_us, self._serialize(message, PACKET))

    def event_array(self, t_us: int, events: Events) -> None:
        as_array = ros1_array if self._bag.ros1 else cdr_array
        sequence = self._counts.get(EVENTS_TOPIC, 0)
        raw = as_array(events, t_us, sequence, FRAME_ID, self._width, self._height)
        self._write(EVENTS_TOPIC, ARRAY, t_us, raw)

    def image(self, t_us: int, image: NDArray[np.uint8]) -> None:
        message = self._store.types[IMAGE](
            header=self._header(IMAGE_TOPIC, t_us),
            height=self._height,
            width=self._width,
            encoding="mono8",
            is_bigendian=0,
            step=self._width,
            data=image.ravel(),
        )
        self._write(IMAGE_TOPIC, IMAGE, t_us, self._serialize(message, IMAGE))

    def _header(self, topic: str, t_us: int) -> Any:
        seconds, us = divmod(t_us, 1_000_000)
        stamp = self._store.types["builtin_interfaces/msg/Time"](sec=seconds, nanosec=1000 * us)
        sequence = {"seq": self._counts.get(topic, 0)} if self._bag.ros1 else {}
        return self._store.types["std_msgs/msg/Header"](stamp=stamp, frame_id=FRAME_ID, **sequence)

    def _write(self, topic: str, kind: str, t_us: int, raw: Any) -> None:
        writer = self._bag.writer
        if topic not in self._connections:
            self._connections[topic] = writer.add_connection(topic, kind, typestore=self._store)
        writer.write(self._connections[topic], 1000 * t_us, raw)
        self._counts[topic] = self._counts.get(topic, 0) + 1


_Write = Callable[[int, Any], None]


def _in_order(recording: Recording, write_events: _Write, image: _Write) -> Iterator[tuple[_Write, int, Any]]:
    """What writes a message, its time and its content, by time."""
    frame_t_us = recording.frame_t_us if recording.frame_t_us is not None else np.empty(0, np.int64)
    frame = 0
    for events in _slices(recording.events):
        t_us = int(events["t"][0])
        while frame < frame_t_us.size and frame_t_us[frame] <= t_us:
            assert recording.frames is not None
            yield image, int(frame_t_us[frame]), recording.frames[frame]
            frame += 1
        yield write_events, t_us, events
    if not recording.events.size:  # one message, for the size of the sensor
        yield write_events, int(frame_t_us[0]) if frame_t_us.size else 0, recording.events
    for number in range(frame, frame_t_us.size):
        assert recording.frames is not None
        yield image, int(frame_t_us[number]), recording.frames[number]


def _slices(events: Events) -> Iterator[Events]:
    """Pieces of the events, in memory, each within a span of MESSAGE_US; none is empty."""
    for block in blocks(events):
        in_memory = np.array(block)
        number = in_memory["t"] // MESSAGE_US
        yield from np.split(in_memory, np.flatnonzero(np.diff(number)) + 1)
