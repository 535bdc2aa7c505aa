"""Images of a topic of ROS 1, published by rospy, into a whole emulator: on the publisher's clock."""

import contextlib
import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from tests.roscore import Ros1, needs_ros1, ros1_running

from voltcam_client.formats import open_writer
from voltcam_server.emulator import Emulator
from voltcam_simulator import Simulator
from voltcam_video import SourceRequest

from .rig import Listener, emulating, moving_frames, tiny, until

pytestmark = needs_ros1

TOPIC, RAW, COMPRESSED = "/camera/image_raw", "sensor_msgs/Image", "sensor_msgs/CompressedImage"
STAMPS_US = np.cumsum([0, 10_000, 3_000, 40_000, 5_000, 5_000, 20_000, 1_000, 9_000, 10_000]).tolist()
FRAMES = moving_frames(len(STAMPS_US), tiny())


@pytest.fixture(scope="module")
def ros1(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ros1]:
    with ros1_running(tmp_path_factory.mktemp("ros1")) as running:
        yield running


@pytest.fixture
def environment(ros1: Ros1, monkeypatch: pytest.MonkeyPatch) -> None:
    for key in ("ROS_MASTER_URI", "ROS_HOSTNAME"):
        monkeypatch.setenv(key, ros1.environment[key])


class Publisher:
    """rospy's, in a process of its own."""

    def __init__(self, ros1: Ros1, kind: str, topic: str = TOPIC) -> None:
        self._process = ros1.peer("publisher", topic, kind)

    def publish(self, t_us: int, data: bytes, **fields: Any) -> None:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(json.dumps([1000 * t_us, fields | {"data": data.hex()}]) + "\n")
        self._process.stdin.flush()
        assert self._process.stdout.readline() == "published\n"

    def image(self, t_us: int, image: NDArray[Any], encoding: str = "mono8", **fields: Any) -> None:
        height, width = image.shape[:2]
        size = {"height": height, "width": width, "step": image.strides[0], "encoding": encoding}
        self.publish(t_us, image.tobytes(), **size | fields)

    def close(self) -> None:
        self._process.kill()
        self._process.communicate(timeout=20)


@contextlib.contextmanager
def publishing(ros1: Ros1, kind: str = RAW) -> Iterator[Publisher]:
    publisher = Publisher(ros1, kind)
    try:
        yield publisher
    finally:
        publisher.close()


Running = tuple[Emulator, Listener]


@pytest.fixture
def running(environment: None) -> Iterator[Running]:
    with emulating(SourceRequest(uri=f"ros1:{TOPIC}", levels="light")) as (emulator, listener):
        yield emulator, listener


def expected(images: NDArray[Any], stamps_us: list[int] = STAMPS_US) -> NDArray[np.void]:
    """The simulator alone, on the same luminance and stamps."""
    simulator = Simulator(24, 16, tiny().parameters)
    return np.concatenate([simulator.advance(image, t) for image, t in zip(images, stamps_us, strict=True)])


def simulated(listener: Listener, count: int) -> None:
    listener.wait(lambda it: len(it.frames) >= count)


def test_the_publisher_s_clock_alone_counts(running: Running, ros1: Ros1) -> None:
    emulator, listener = running
    assert emulator.source.state == "waiting"
    with publishing(ros1) as publisher:
        for number, (frame, t_us) in enumerate(zip(FRAMES, STAMPS_US, strict=True)):
            publisher.image(t_us, frame)
            simulated(listener, number + 1)
    assert [frame.t_us for frame in listener.frames] == STAMPS_US
    assert listener.events.tobytes() == expected(FRAMES).tobytes()
    assert len(listener.events) > 500
    assert emulator.source.granted is not None
    assert emulator.source.granted["pixel_format"] == "mono8"
    assert (emulator.source.granted["clock"], emulator.source.granted["width"]) == ("sender", 24)


def test_sixteen_bits_of_a_big_endian_machine_with_padded_rows(running: Running, ros1: Ros1) -> None:
    _, listener = running
    wide = FRAMES.astype(np.uint16) * 256 + 77
    with publishing(ros1) as publisher:
        for number, (frame, t_us) in enumerate(zip(wide, STAMPS_US, strict=True)):
            padded = np.pad(frame, ((0, 0), (0, 3)), constant_values=9999).astype(">u2")
            size = {"width": 24, "step": padded.strides[0]}
            publisher.image(t_us, padded, "mono16", is_bigendian=1, **size)
            simulated(listener, number + 1)
    assert listener.events.tobytes() == expected(wide.astype(np.float32) / np.float32(257)).tobytes()


def test_compressed_images(running: Running, ros1: Ros1) -> None:
    _, listener = running
    with publishing(ros1, COMPRESSED) as publisher:
        for number, (frame, t_us) in enumerate(zip(FRAMES, STAMPS_US, strict=True)):
            publisher.publish(t_us, cv2.imencode(".png", frame)[1].tobytes(), format="mono8; png compressed ")
            simulated(listener, number + 1)
    assert listener.events.tobytes() == expected(FRAMES).tobytes()


def test_a_bag_that_is_played_drives_the_camera_in_recorded_time(
    environment: None, ros1: Ros1, tmp_path: Path
) -> None:
    """By rosbag's player, which is written in C++: the other library that speaks ROS 1."""
    stamps_us = [1_700_000_000_000_000 + t_us for t_us in STAMPS_US]
    with open_writer(tmp_path / "frames.bag", width=24, height=16) as writer:
        for frame, t_us in zip(FRAMES, stamps_us, strict=True):
            writer.frame(frame, t_us)
    with emulating(SourceRequest(uri="ros1:/dvs/image_raw", levels="light")) as (_, listener):
        play = ["rosbag", "play", "--quiet", "--rate", "0.1", "--wait-for-subscribers"]
        ros1.run(*play, "--topics", "/dvs/image_raw", "--bags", str(tmp_path / "frames.bag"))
        simulated(listener, len(FRAMES))
    assert [frame.t_us for frame in listener.frames] == stamps_us
    assert listener.events.tobytes() == expected(FRAMES, stamps_us).tobytes()


def test_frames_that_come_too_fast_are_counted(running: Running, ros1: Ros1) -> None:
    emulator, listener = running
    with publishing(ros1) as publisher:
        publisher.image(0, FRAMES[0])
        simulated(listener, 1)
        follow = emulator.simulation.follow

        def slowly(arrival: Any, *rest: Any) -> Any:
            until(lambda: emulator.status.frames.received >= 40, "all have come")
            return follow(arrival, *rest)

        emulator.simulation.follow = slowly  # type: ignore[method-assign]
        for number in range(1, 41):
            publisher.image(10_000 * number, FRAMES[number % 10])
        listener.wait(lambda it: it.frames[-1].t_us == 400_000)
    frames = emulator.status.frames
    assert frames.received == 41
    assert frames.dropped + len(listener.frames) == 41
    assert frames.dropped > 20


def test_a_simulator_that_is_reset_begins_again(running: Running, ros1: Ros1) -> None:
    emulator, listener = running
    with publishing(ros1) as publisher:
        for number, t_us in enumerate((5_000_000, 5_010_000, 0, 10_000)):
            publisher.image(t_us, FRAMES[number])
            simulated(listener, number + 1)
    assert (np.diff([frame.t_us for frame in listener.frames]) > 0).all()
    assert emulator.simulation.shift_us > 5_000_000


def test_a_publisher_that_comes_again_is_heard_again(running: Running, ros1: Ros1) -> None:
    _, listener = running
    for number in range(2):
        with publishing(ros1) as publisher:
            publisher.image(10_000 * number, FRAMES[number])
            simulated(listener, number + 1)


def test_a_topic_of_another_type_is_said(running: Running, ros1: Ros1) -> None:
    emulator, _ = running
    with publishing(ros1, "event_camera_msgs/EventPacket"):
        until(lambda: emulator.source.state == "reconnecting", "it is told")
    words = "ros1:/camera/image_raw: /camera/image_raw is of type event_camera_msgs/EventPacket: give a topic"
    assert emulator.source.message.startswith(words)


def test_a_publisher_without_stamps_is_said(running: Running, ros1: Ros1) -> None:
    emulator, listener = running
    with publishing(ros1) as publisher:
        for _ in range(1000):  # some may be dropped
            publisher.image(0, FRAMES[0])
            if emulator.source.state == "reconnecting":
                break
            time.sleep(0.01)
        assert "does its publisher set header.stamp?" in emulator.source.message
        for number in range(1, 100):  # the first may go to the connection that has ended
            publisher.image(10_000 * number, FRAMES[number % 10])
            if len(listener.frames) > 1:
                break
            time.sleep(0.1)
        simulated(listener, 2)


def test_the_daemon_outlives_the_roscore(
    tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    with ros1_running(tmp_path_factory.mktemp("other")) as ros1:
        for key in ("ROS_MASTER_URI", "ROS_HOSTNAME"):
            monkeypatch.setenv(key, ros1.environment[key])
        with emulating(SourceRequest(uri=f"ros1:{TOPIC}", levels="light")) as (emulator, listener):
            for number in range(2):
                with publishing(ros1) as publisher:
                    publisher.image(10_000 * number, FRAMES[number])
                    simulated(listener, number + 1)
                if number == 0:
                    ros1.stop()
                    until(lambda: emulator.source.state == "reconnecting", "it is missed")
                    assert "roscore" in emulator.source.message
                    ros1.start()
