"""A camera on the topics of a roscore, heard by rospy in another process, with genpy's classes."""

import json
import subprocess
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.client.conftest import Publisher
from tests.roscore import Ros1, needs_ros1

from voltcam_client import EventCamera, FrameMessage, Packet
from voltcam_client.encodings import ENCODINGS, EVENT, Events
from voltcam_client.formats import read
from voltcam_client.intrinsics import Intrinsics
from voltcam_client.packet import TOPIC_EVENTS, TOPIC_FRAMES
from voltcam_client.ros1 import RosError
from voltcam_client.ros1.bridge import Bridge, BridgeSettings
from voltcam_client.ros1.names import Names
from voltcam_client.ros1.node import Node
from voltcam_client.ros1.xml_rpc import call
from voltcam_client.samples import IMU, TOPIC_IMU, SamplesMessage, encode_samples

pytestmark = needs_ros1

START_US = 1_700_000_000_123_456
EVENTS, ARRAYS = "event_camera_msgs/EventPacket", "dvs_msgs/EventArray"
Heard = dict[str, list[dict[str, Any]]]


def packets(count: int, size: int, encoding: str = "libcaer") -> list[Packet]:
    """Random events of a 346 x 260 camera, a millisecond each."""
    rng = np.random.default_rng(7)
    made = []
    for seq in range(count):
        events = np.empty(size, EVENT)
        start_us = START_US + 1000 * seq
        events["t"] = start_us + np.sort(rng.integers(0, 1000, size))
        events["x"], events["y"] = rng.integers(0, 346, size), rng.integers(0, 260, size)
        events["p"] = rng.integers(0, 2, size)
        made.append(
            Packet(
                events=events,
                height=260,
                width=346,
                seq=seq,
                time_base_ns=1000 * start_us,
                stamp_ns=time.time_ns(),
                encoding=encoding,
                frame_id="left",
            )
        )
    return made


@contextmanager
def bridging(ros1: Ros1, url: str, settings: BridgeSettings, *remappings: str) -> Iterator[Node]:
    names = Names.of("voltcam", remappings, ros1.environment)
    over = threading.Event()
    with EventCamera(url) as camera, Node(names) as node:
        bridge = Bridge(node, camera, settings)
        thread = threading.Thread(target=bridge.run, args=(over.is_set,))
        thread.start()
        try:
            yield node
        finally:
            over.set()
            thread.join()


def until_connected(uri: str, topics: Sequence[str]) -> None:
    """Until the node has a subscriber of each."""
    deadline = time.monotonic() + 30
    while Counter(link[4] for link in call(uri, "getBusInfo", "/test")) != Counter(topics):
        assert time.monotonic() < deadline, "nobody subscribed"
        time.sleep(0.02)


def heard(ros1: Ros1, uri: str, topics: dict[str, str], count: int, send: Callable[[], None]) -> Heard:
    """So many messages of each topic, as another process has decoded them, of what is sent then."""
    arguments = [part for topic in topics.items() for part in topic]
    peer = ros1.peer("subscriber", str(count), *arguments)
    try:
        until_connected(uri, list(topics))
        send()
        output, error = peer.communicate(timeout=60)
    finally:
        peer.kill()
        peer.wait()
    assert not error
    came: Heard = {topic: [] for topic in topics}
    for line in output.splitlines():
        topic, message = json.loads(line)
        came[topic].append(message)
    return came


def of_array(message: dict[str, Any]) -> Events:
    events = np.empty(len(message["events"]), EVENT)
    for name, key in (("t", "ts"), ("x", "x"), ("y", "y"), ("p", "polarity")):
        events[name] = [event[key] // (1000 if name == "t" else 1) for event in message["events"]]
    return events


def of_packet(message: dict[str, Any]) -> Events:
    codec = ENCODINGS[message["encoding"]]
    return codec.decode(bytes.fromhex(message["events"]), message["time_base"] // 1000)


@pytest.mark.parametrize("encoding", sorted(ENCODINGS))
def test_packets_hold_the_daemon_s_own_bytes(ros1: Ros1, publisher: Publisher, encoding: str) -> None:
    sent = packets(20, 300, encoding)

    def send() -> None:
        publisher.wait_for_subscribers(TOPIC_EVENTS)
        publisher.send(*sent)

    with bridging(ros1, publisher.url, BridgeSettings()) as node:
        came = heard(ros1, node.uri, {"/dvs/events": EVENTS}, len(sent), send)["/dvs/events"]
    for ours, theirs in zip(sent, came, strict=True):
        assert theirs["header"] == {"seq": ours.seq, "stamp": ours.time_base_ns, "frame_id": "left"}
        assert [theirs[key] for key in ("height", "width", "seq")] == [260, 346, ours.seq]
        assert (theirs["time_base"], theirs["encoding"]) == (ours.time_base_ns, encoding)
        assert not theirs["is_bigendian"]
        assert of_packet(theirs).tobytes() == ours.events.tobytes()


def test_arrays_hold_the_same_events(ros1: Ros1, publisher: Publisher) -> None:
    sent = [*packets(5, 1000), *packets(1, 0)]

    def send() -> None:
        publisher.wait_for_subscribers(TOPIC_EVENTS)
        publisher.send(*sent)

    with bridging(ros1, publisher.url, BridgeSettings(events="array")) as node:
        came = heard(ros1, node.uri, {"/dvs/events": ARRAYS}, len(sent), send)["/dvs/events"]
    for ours, theirs in zip(sent, came, strict=True):
        assert theirs["header"]["stamp"] == ours.time_base_ns
        assert (theirs["height"], theirs["width"]) == (260, 346)
        assert of_array(theirs).tobytes() == ours.events.tobytes()


@pytest.mark.parametrize("events", ["packet", "array"])
def test_rosbag_records_what_comes(ros1: Ros1, publisher: Publisher, events: Any, tmp_path: Path) -> None:
    """It is written in C++: the other library that speaks ROS 1."""
    sent, bag = packets(20, 300), tmp_path / "a.bag"
    with bridging(ros1, publisher.url, BridgeSettings(events=events)) as node:
        command = ["rosbag", "record", "--limit", str(len(sent)), "-O", str(bag), "/dvs/events"]
        recorder = subprocess.Popen(command, env=ros1.environment, stdout=subprocess.DEVNULL)
        try:
            until_connected(node.uri, ["/dvs/events"])
            publisher.wait_for_subscribers(TOPIC_EVENTS)
            publisher.send(*sent)
            assert recorder.wait(60) == 0
        finally:
            recorder.kill()
            recorder.wait()
    assert read(bag).events.tobytes() == b"".join(packet.events.tobytes() for packet in sent)


def frame(seq: int) -> FrameMessage:
    image = np.random.default_rng(seq).integers(0, 256, (30, 40), np.uint8)
    t_us = START_US + 10_000 * seq
    exposure_us = t_us - 2000, t_us + 2000
    return FrameMessage(
        image=image, seq=seq, t_us=t_us, stamp_ns=time.time_ns(), frame_id="left", exposure_us=exposure_us
    )


def test_images_with_their_intrinsics(ros1: Ros1, publisher: Publisher) -> None:
    k, p = tuple(float(n) for n in range(9)), tuple(float(n) / 7 for n in range(12))
    intrinsics = Intrinsics((40, 30), "plumb_bob", (0.1, -0.2, 0.0, 1e-3, 0.5), k, k[::-1], p)
    sent = [frame(seq) for seq in range(4)]

    def send() -> None:
        publisher.wait_for_subscribers(TOPIC_FRAMES)
        publisher.send(*sent)

    topics = {"/robot/eye/image_raw": "sensor_msgs/Image", "/robot/eye/camera_info": "sensor_msgs/CameraInfo"}
    settings = BridgeSettings(namespace="eye", intrinsics=intrinsics, frame_id="optical")
    with bridging(ros1, publisher.url, settings, "__ns:=/robot") as node:
        images, infos = heard(ros1, node.uri, topics, len(sent), send).values()
    for ours, image, info in zip(sent, images, infos, strict=True):
        assert image["header"] == {"seq": ours.seq, "stamp": 1000 * ours.t_us, "frame_id": "optical"}
        assert bytes.fromhex(image["data"]) == ours.image.tobytes()
        assert [image[key] for key in ("height", "width", "step")] == [30, 40, 40]
        assert (image["encoding"], image["is_bigendian"]) == ("mono8", 0)
        assert info["header"] == image["header"]
        assert (info["height"], info["width"], info["distortion_model"]) == (30, 40, "plumb_bob")
        assert tuple(info["D"]) == intrinsics.distortion
        assert (tuple(info["K"]), tuple(info["R"]), tuple(info["P"])) == (k, k[::-1], p)
        assert not any(info["roi"].values())


def test_imu_in_ros_units(ros1: Ros1, publisher: Publisher) -> None:
    samples = np.zeros(3, IMU)
    samples["t"] = START_US + 1000 * np.arange(3)
    samples["accel_g"], samples["gyro_deg_s"] = (0, -1, 0), (180, 0, -90)

    def send() -> None:
        publisher.wait_for_subscribers(TOPIC_IMU)
        message = SamplesMessage(samples=samples, seq=0, stamp_ns=time.time_ns())
        publisher.send_raw(TOPIC_IMU, *encode_samples(message))

    with bridging(ros1, publisher.url, BridgeSettings()) as node:
        came = heard(ros1, node.uri, {"/dvs/imu": "sensor_msgs/Imu"}, 3, send)["/dvs/imu"]
    assert [each["header"]["stamp"] for each in came] == (1000 * samples["t"]).tolist()
    for each in came:
        assert list(each["linear_acceleration"].values()) == pytest.approx([0, -9.80665, 0])
        assert list(each["angular_velocity"].values()) == pytest.approx([np.pi, 0, -np.pi / 2])
        assert each["orientation_covariance"][0] == -1
        assert not any(each["linear_acceleration_covariance"])


def test_the_clock_is_the_events_clock(ros1: Ros1, publisher: Publisher) -> None:
    sent = packets(3, 50)

    def send() -> None:
        publisher.wait_for_subscribers(TOPIC_EVENTS)
        publisher.send(*sent)

    with bridging(ros1, publisher.url, BridgeSettings(clock=True)) as node:
        came = heard(ros1, node.uri, {"/clock": "rosgraph_msgs/Clock"}, 3, send)["/clock"]
    assert [each["clock"] for each in came] == [1000 * int(each.events["t"][-1]) for each in sent]


def test_a_calibration_of_another_size_is_said(ros1: Ros1, publisher: Publisher) -> None:
    settings = BridgeSettings(intrinsics=Intrinsics((640, 480), "plumb_bob"))
    names = Names.of("voltcam", [], ros1.environment)
    with EventCamera(publisher.url) as camera, Node(names) as node:
        bridge = Bridge(node, camera, settings)
        threading.Timer(0.5, publisher.send, [frame(0)]).start()
        deadline = time.monotonic() + 30
        with pytest.raises(RosError, match="640 x 480 pixels, and the camera has 40 x 30"):
            bridge.run(lambda: time.monotonic() > deadline)


def test_a_time_that_ros_has_not_ends_it_in_a_line(ros1: Ros1, publisher: Publisher) -> None:
    (packet,) = packets(1, 0)
    late = replace(packet, time_base_ns=10**9 << 32)
    with EventCamera(publisher.url) as camera, Node(Names.of("voltcam", [], ros1.environment)) as node:
        bridge = Bridge(node, camera, BridgeSettings())
        peer = ros1.peer("subscriber", "1", "/dvs/events", EVENTS)
        try:
            until_connected(node.uri, ["/dvs/events"])
            threading.Timer(0.5, publisher.send, [late]).start()
            deadline = time.monotonic() + 30
            with pytest.raises(ValueError, match=r"ROS 1 has no times after 2\^32 s"):
                bridge.run(lambda: time.monotonic() > deadline)
        finally:
            peer.kill()
            peer.communicate()


def test_a_daemon_that_is_started_again_is_heard_again(ros1: Ros1, publish: Callable[..., Publisher]) -> None:
    first, (one, two) = publish(), packets(2, 100)

    def send() -> None:
        first.wait_for_subscribers(TOPIC_EVENTS)
        first.send(one)
        time.sleep(0.2)
        first.close()
        second = publish(port=first.port)
        second.wait_for_subscribers(TOPIC_EVENTS)
        second.send(two)

    with bridging(ros1, first.url, BridgeSettings()) as node:
        came = heard(ros1, node.uri, {"/dvs/events": EVENTS}, 2, send)["/dvs/events"]
    assert [each["seq"] for each in came] == [0, 1]
