"""Bags as rosbags' own writers and serializers make them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from voltcam_client.encodings import ENCODINGS
from voltcam_client.formats import FormatError, read

pytest.importorskip("rosbags", reason="rosbags, the oracle, is in the extra [lab]")
from rosbags import rosbag1, rosbag2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

START_US = 1_700_000_000_000_000
ARRAY = "std_msgs/Header header\nuint32 height\nuint32 width\n{package}/Event[] events"
EVENT_FIELDS = {
    "bag": "uint16 x\nuint16 y\ntime ts\nbool polarity",
    "ros2": "uint16 x\nuint16 y\nbuiltin_interfaces/Time ts\nbool polarity",
}
PACKET = (
    "std_msgs/Header header\nuint32 height\nuint32 width\nuint64 seq\nuint64 time_base\nstring encoding\n"
    "bool is_bigendian\nuint8[] events"
)
KINDS = ("bag", "folder", "mcap", "db3")


class Bag:
    """A bag being written; `kind` as in KINDS."""

    def __init__(self, folder: Path, kind: str) -> None:
        self.ros1 = kind == "bag"
        self.store = get_typestore(Stores.ROS1_NOETIC if self.ros1 else Stores.ROS2_HUMBLE)
        fields = EVENT_FIELDS["bag" if self.ros1 else "ros2"]
        for package in ("dvs_msgs", "prophesee_event_msgs"):
            self.store.register(get_types_from_msg(fields, f"{package}/msg/Event"))
            self.store.register(
                get_types_from_msg(ARRAY.format(package=package), f"{package}/msg/EventArray")
            )
        self.store.register(get_types_from_msg(PACKET, "event_camera_msgs/msg/EventPacket"))
        self.kind = kind
        self.folder = folder / ("a.bag" if self.ros1 else "bag")
        plugin = rosbag2.StoragePlugin.MCAP if kind == "mcap" else rosbag2.StoragePlugin.SQLITE3
        self.writer: Any = (
            rosbag1.Writer(self.folder)
            if self.ros1
            else rosbag2.Writer(self.folder, version=9, storage_plugin=plugin)
        )
        self.connections: dict[str, Any] = {}

    @property
    def path(self) -> Path:
        return next(self.folder.glob(f"*.{self.kind}")) if self.kind in ("mcap", "db3") else self.folder

    def __enter__(self) -> "Bag":
        self.writer.open()
        return self

    def __exit__(self, *_: object) -> None:
        self.writer.close()

    def header(self, t_us: int) -> Any:
        seconds, us = divmod(t_us, 1_000_000)
        stamp = self.type("builtin_interfaces/msg/Time")(sec=seconds, nanosec=1000 * us)
        sequence = {"seq": 0} if self.ros1 else {}
        return self.type("std_msgs/msg/Header")(stamp=stamp, frame_id="camera", **sequence)

    def type(self, name: str) -> Any:
        return self.store.types[name]

    def write(self, topic: str, name: str, log_us: int, **fields: Any) -> None:
        message = self.type(name)(**fields)
        if topic not in self.connections:
            self.connections[topic] = self.writer.add_connection(topic, name, typestore=self.store)
        raw = getattr(self.store, "serialize_ros1" if self.ros1 else "serialize_cdr")(message, name)
        self.writer.write(self.connections[topic], 1000 * log_us, raw)

    def array(self, events: np.ndarray, topic: str = "/dvs/events", package: str = "dvs_msgs") -> None:
        time, event = self.type("builtin_interfaces/msg/Time"), self.type(f"{package}/msg/Event")
        rows = [
            event(x=x, y=y, ts=time(sec=t // 10**6, nanosec=1000 * (t % 10**6)), polarity=p)
            for t, x, y, p in events.tolist()
        ]
        t_us = int(events["t"][0]) if events.size else START_US
        self.write(
            topic,
            f"{package}/msg/EventArray",
            t_us,
            header=self.header(t_us),
            height=260,
            width=346,
            events=rows,
        )

    def packet(self, buffer: bytes, encoding: str, stamp_us: int, time_base: int) -> None:
        self.write(
            "/event_camera/events", "event_camera_msgs/msg/EventPacket", stamp_us,
            header=self.header(stamp_us), height=260, width=346, seq=0, time_base=time_base,
            encoding=encoding, is_bigendian=False, events=np.frombuffer(buffer, np.uint8),
        )  # fmt: skip

    def image(self, t_us: int, image: np.ndarray, encoding: str, topic: str = "/dvs/image_raw") -> None:
        rows = image.reshape(image.shape[0], -1)
        padded = np.concatenate([rows, np.full((rows.shape[0], 6), 99, np.uint8)], axis=1)
        height, width = image.shape[:2]
        self.write(
            topic, "sensor_msgs/msg/Image", t_us, header=self.header(t_us), height=height, width=width,
            encoding=encoding, is_bigendian=0, step=padded.shape[1], data=padded.ravel(),
        )  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("package", ["dvs_msgs", "prophesee_event_msgs"])
def test_event_arrays(kind: str, package: str, tmp_path: Path, make_events) -> None:
    events = make_events(1001, START_US)
    with Bag(tmp_path, kind) as bag:
        for part in np.split(events, [1, 1, 3, 500]):  # one event, none, two, many
            bag.array(part, package=package)
    recording = read(bag.path)
    np.testing.assert_array_equal(recording.events, events)
    assert (recording.width, recording.height, recording.frames) == (346, 260, None)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_event_packets(kind: str, encoding: str, tmp_path: Path, make_events) -> None:
    events = make_events(1000, START_US)
    with Bag(tmp_path, kind) as bag:
        for part in np.array_split(events, 5):
            base_us = int(part["t"][0])
            bag.packet(ENCODINGS[encoding].encode(part, base_us), encoding, base_us, 1000 * base_us)
    np.testing.assert_array_equal(read(bag.path).events, events)


def test_packets_on_a_sensors_own_clock(tmp_path: Path, make_events) -> None:
    """As Prophesee's drivers send them: cut anywhere, time_base 0, the clock turning over on the way."""
    events = make_events(1000, start_us=2**24 - 100_000)
    buffer = ENCODINGS["evt3"].encode(events, 2**24 - 100_000)
    with Bag(tmp_path, "folder") as bag:
        for i, start in enumerate(range(0, len(buffer), 700)):
            bag.packet(buffer[start : start + 700], "evt3", START_US + 10_000 * i, 0)
    read_back = read(bag.path).events
    events["t"] += START_US - events["t"][0]
    np.testing.assert_array_equal(read_back, events)


@pytest.mark.parametrize(
    ("encoding", "depth", "grey"), [("mono8", 1, 200), ("bgr8", 3, 23), ("rgb8", 3, 60), ("bgra8", 4, 23)]
)
@pytest.mark.parametrize("kind", KINDS[:2])
def test_images(kind: str, encoding: str, depth: int, grey: int, tmp_path: Path, make_events) -> None:
    """Blue 200 in BGR is 0.114 * 200 grey, red 200 in RGB 0.299 * 200."""
    image = np.zeros((260, 346, depth), np.uint8)
    image[..., 0] = 200
    with Bag(tmp_path, kind) as bag:
        bag.array(make_events(10, START_US))
        for t_us in (START_US + 80_000, START_US + 40_000):
            bag.image(t_us, image, encoding)
    recording = read(bag.path)
    assert recording.frames.shape == (2, 260, 346)
    assert set(recording.frames.ravel()) == {grey}
    assert recording.frame_t_us.tolist() == [START_US + 40_000, START_US + 80_000]


def test_of_two_cameras_the_busier_one_with_its_own_images(tmp_path: Path, make_events) -> None:
    events = make_events(30, START_US)
    with Bag(tmp_path, "bag") as bag:
        bag.array(events[:10], "/davis/right/events")
        for part in np.array_split(events, 3):
            bag.array(part, "/davis/left/events")
        for _ in range(3):
            bag.image(START_US, np.full((260, 346), 9, np.uint8), "mono8", "/davis/right/image_raw")
        bag.image(START_US, np.full((260, 346), 5, np.uint8), "mono8", "/davis/left/image_raw")
    recording = read(bag.path)
    np.testing.assert_array_equal(recording.events, events)
    assert set(recording.frames.ravel()) == {5}


def test_messages_that_come_late_are_put_in_order(tmp_path: Path, make_events) -> None:
    events = make_events(100, START_US)
    with Bag(tmp_path, "folder") as bag:
        bag.array(events[50:])
        bag.array(events[:50])
    np.testing.assert_array_equal(read(bag.path).events, events)


def test_what_cannot_be_read_is_named(tmp_path: Path, make_events) -> None:
    with Bag(tmp_path, "bag") as bag:
        bag.image(START_US, np.zeros((4, 4), np.uint8), "mono8")
    with pytest.raises(FormatError, match=r"no topic of events, only /dvs/image_raw \(sensor_msgs"):
        read(bag.path)
    with Bag(tmp_path, "folder") as bag:
        bag.packet(b"", "evt2", START_US, 0)
    with pytest.raises(FormatError, match="its events are in 'evt2': record them in libcaer, mono"):
        read(bag.path)
    (tmp_path / "other").mkdir()
    with Bag(tmp_path / "other", "bag") as bag:
        bag.array(make_events(3, START_US))
        bag.image(START_US, np.zeros((4, 4), np.uint8), "bayer_rggb8")
    with pytest.raises(FormatError, match="/dvs/image_raw is in 'bayer_rggb8': record mono8"):
        read(bag.path)


@pytest.mark.parametrize("suffix", [".bag", ".mcap", ".db3"])
def test_what_is_no_bag(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"a{suffix}"
    path.write_bytes(b"no bag at all")
    with pytest.raises(FormatError, match="is cut short or no ROS bag") as error:
        read(path)
    assert "\n" not in str(error.value)
