"""A topic's images as frames, and bytes that are none; rospy's own are in tests/server/test_ros1.py."""

import contextlib
import struct
import threading
from collections.abc import Iterator

import cv2
import numpy as np
import pytest
from tests.client.ros1.master import Master, mastering
from tests.ports import free_port

from voltcam_client.ros1.node import Node
from voltcam_client.ros1.publication import Publication
from voltcam_video import Frame, Source, SourceError, SourceRequest, luminance, open_source
from voltcam_video.clock import Clock

RAW, COMPRESSED = "sensor_msgs/Image", "sensor_msgs/CompressedImage"
REQUEST = SourceRequest(uri="ros1:/camera/image_raw")


@pytest.fixture
def master(monkeypatch: pytest.MonkeyPatch) -> Iterator[Master]:
    with mastering() as running:
        monkeypatch.setenv("ROS_MASTER_URI", running.uri)
        monkeypatch.setenv("ROS_HOSTNAME", "127.0.0.1")
        yield running


class Topic:
    """A source, and who publishes what it looks at."""

    def __init__(self, master: Master, kind: str) -> None:
        self._stop = threading.Event()
        self._node = Node(master.names("gazebo"))
        self.publication: Publication = self._node.advertise("/camera/image_raw", kind, 10)
        self.source: Source = open_source(REQUEST, Clock(), self._stop)
        while not self.publication.wanted:
            self._stop.wait(0.01)

    def frame(self, *bodies: bytes) -> Frame:
        """Of these messages, the last of which has one."""
        for body in bodies:
            self.publication.publish(body)
        watchdog = threading.Timer(20, self._stop.set)
        watchdog.start()
        frame = self.source.read()
        watchdog.cancel()
        assert frame is not None, "no frame"
        return frame

    @contextlib.contextmanager
    def again_and_again(self, body: bytes) -> Iterator[None]:
        over = threading.Event()

        def publish() -> None:
            while not over.wait(0.005):
                self.publication.publish(body)

        thread = threading.Thread(target=publish)
        thread.start()
        try:
            yield
        finally:
            over.set()
            thread.join()

    def close(self) -> None:
        self.source.close()
        self._node.close()


@pytest.fixture
def topic(master: Master) -> Iterator[Topic]:
    topic = Topic(master, RAW)
    yield topic
    topic.close()


@pytest.fixture
def compressed(master: Master) -> Iterator[Topic]:
    topic = Topic(master, COMPRESSED)
    yield topic
    topic.close()


def text(value: str) -> bytes:
    return struct.pack("<I", len(value)) + value.encode()


def header(t_us: int, frame_id: str = "camera") -> bytes:
    return struct.pack("<III", 7, t_us // 1_000_000, t_us % 1_000_000 * 1000) + text(frame_id)


def message(t_us: int, image: np.ndarray, encoding: str = "mono8", frame_id: str = "camera") -> bytes:
    """sensor_msgs/Image of an image without padding."""
    size = struct.pack("<II", *image.shape[:2])
    layout = text(encoding) + struct.pack("<BI", 0, image.strides[0])
    return header(t_us, frame_id) + size + layout + struct.pack("<I", image.nbytes) + image.tobytes()


GREY = np.arange(6 * 8, dtype=np.uint8).reshape(6, 8)


@pytest.mark.parametrize("frame_id", ["", "a", "camera_optical_frame"])
def test_an_image_and_its_stamp(topic: Topic, frame_id: str) -> None:
    frame = topic.frame(message(1_700_000_000_123_456, GREY, frame_id=frame_id))
    assert frame.t_us == 1_700_000_000_123_456
    np.testing.assert_array_equal(frame.image, GREY)
    assert frame.sent is not None
    assert not frame.sent.wait
    granted = topic.source.granted
    assert (granted["width"], granted["height"], granted["clock"]) == (8, 6, "sender")


def test_colour(topic: Topic) -> None:
    rgb = np.random.default_rng(2).integers(0, 256, (6, 8, 3), np.uint8)
    frame = topic.frame(message(5, rgb, "rgb8"))
    np.testing.assert_array_equal(frame.image, luminance(rgb[..., ::-1]))


def test_a_compressed_image(compressed: Topic) -> None:
    png = cv2.imencode(".png", GREY)[1].tobytes()
    frame = compressed.frame(header(9) + text("mono8; png compressed ") + struct.pack("<I", len(png)) + png)
    assert frame.t_us == 9
    np.testing.assert_array_equal(frame.image, GREY)


def test_another_size_and_an_earlier_time_begin_another_run(topic: Topic) -> None:
    frames = [
        topic.frame(message(t_us, image))
        for t_us, image in ((50, GREY), (60, GREY), (70, GREY[:4]), (5, GREY[:4]))
    ]
    assert [frame.cut for frame in frames] == [False, False, True, True]


def test_what_is_lost_is_counted(topic: Topic) -> None:
    topic.frame(message(1, GREY))
    for number in range(2, 40):
        topic.publication.publish(message(number, GREY))
    missed = 0
    frame = topic.frame()
    while frame.t_us < 39:
        assert frame.sent is not None
        missed += 1 + frame.sent.missed
        frame = topic.frame()
    assert frame.sent is not None
    assert missed + frame.sent.missed + topic.publication.dropped == 37


BAD = {
    "nothing": b"",
    "cut in its header": message(2, GREY)[:20],
    "cut in its image": message(2, GREY)[:-1],
    "with more behind": message(2, GREY) + b"\0",
    "of a long frame_id": header(2)[:12] + b"\xff\xff\xff\xff",
    "of 4 GB": message(2, GREY)[:-52] + b"\xff\xff\xff\xff" + GREY.tobytes(),
    "of no encoding": message(2, GREY, "32FC1"),
    "of another size": message(2, GREY).replace(struct.pack("<II", 6, 8), struct.pack("<II", 60000, 60000)),
    "of the same stamp": message(3, GREY),
}


@pytest.mark.parametrize("bad", BAD.values(), ids=BAD.keys())
def test_an_image_that_is_none_is_left_out(topic: Topic, bad: bytes) -> None:
    """Many in a row are said."""
    topic.frame(message(3, GREY))
    assert topic.frame(bad, message(4, GREY)).t_us == 4
    topic.frame(message(3, GREY))
    with topic.again_and_again(bad), pytest.raises(SourceError) as caught:
        topic.source.read()
    assert str(caught.value).startswith("ros1:/camera/image_raw: ")
    assert "\n" not in str(caught.value)


def test_a_first_image_that_is_none_is_said(topic: Topic) -> None:
    with pytest.raises(SourceError, match="'32FC1': publish it in one of mono8"):
        topic.frame(message(1, GREY, "32FC1"))


def test_random_bytes(topic: Topic) -> None:
    rng, good = np.random.default_rng(4), message(2, GREY)
    topic.frame(message(1, GREY))
    for number in range(300):
        body = bytearray(good if number % 2 else rng.bytes(int(rng.integers(0, 200))))
        for at in rng.integers(0, max(1, len(body)), 3):
            body[at : at + 1] = rng.bytes(1)
        # The good one is later than all that these bytes can say.
        frame = topic.frame(bytes(body), message((1 << 32) * 1_000_000 - 1000 + number, GREY))
        assert frame.image.ndim == 2


def test_without_a_roscore_it_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", f"http://127.0.0.1:{free_port()}")
    with pytest.raises(SourceError, match=r"^ros1:/camera/image_raw: no roscore \(nobody answers"):
        open_source(REQUEST)


def test_a_name_that_is_none_is_said(master: Master) -> None:
    with pytest.raises(SourceError, match=r"^ros1:a-b: .a-b. is no name of ROS 1"):
        open_source(SourceRequest(uri="ros1:a-b"))
