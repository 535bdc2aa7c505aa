"""ROS 2: Cyclone's own deserialiser, in another process, reads; a stalled reader costs only itself."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

pytest.importorskip("cyclonedds", reason="cyclonedds is in the extra [ros2]")
from tests.ros2 import DOMAIN, Reader, own_namespace

from voltcam_client.encodings import ENCODINGS
from voltcam_client.intrinsics import Intrinsics
from voltcam_client.packet import EVENT, TOPIC_EVENTS, TOPIC_FRAMES, FrameMessage, Packet
from voltcam_client.samples import IMU, TOPIC_IMU, TOPIC_TRIGGERS, TRIGGER, SamplesMessage
from voltcam_server.messages import events_message, frame_message, samples_message, status_message
from voltcam_server.problems import UsageError
from voltcam_server.transports import Ros2Transport
from voltcam_server.transports import ros2 as ros2_module

from ..process import Daemon, voltcam
from ..rig import until

START_US = 1_700_000_000_000_000
CALIBRATION = """\
image_width: 40
image_height: 30
distortion_model: plumb_bob
distortion_coefficients: {data: [0, 0, 0, 0, 0]}
camera_matrix: {data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}
rectification_matrix: {data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}
projection_matrix: {data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]}
"""
LARGEST = {TOPIC_EVENTS: 65536, TOPIC_FRAMES: 346 * 260, TOPIC_IMU: 400}


def packet(seq: int, count: int) -> Packet:
    events = np.zeros(count, EVENT)
    base_us = START_US + 1000 * seq
    events["t"] = base_us + np.arange(count) * 1000 // max(1, count)
    events["x"], events["y"], events["p"] = seq % 346, np.arange(count) % 260, np.arange(count) % 2
    return Packet(
        events=events,
        width=346,
        height=260,
        seq=seq,
        time_base_ns=1000 * base_us,
        stamp_ns=1,
        frame_id="davis",
    )


@pytest.fixture(autouse=True)
def domain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", DOMAIN)
    monkeypatch.delenv("ROS_AUTOMATIC_DISCOVERY_RANGE", raising=False)


@pytest.fixture
def transport() -> Iterator[Ros2Transport]:
    transport = Ros2Transport(own_namespace(), "libcaer", LARGEST)
    transport.start()
    yield transport
    transport.stop()
    assert transport.failure is None


def decoded(message: dict[str, Any]) -> NDArray[np.void]:
    decode = ENCODINGS[message["encoding_"]].decode
    return decode(
        bytes.fromhex(message["events_"]) if message["events_"] else b"", message["time_base_"] // 1000
    )


def wanted(transport: Ros2Transport, topic: bytes, by: int = 1) -> bool:
    return all(writer.readers >= by for writer, _ in transport._topics[topic])


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("reliability", ["reliable", "best_effort"])
def test_every_event_is_read(encoding: str, reliability: str, tmp_path: Path) -> None:
    transport = Ros2Transport(own_namespace(), encoding, LARGEST)
    packets = [packet(seq, 37 * seq % 3000) for seq in range(40)]
    topic = f"{transport.namespace}/events"
    with Reader(topic, "EventPacket", len(packets), tmp_path / "out", reliability) as reader:
        transport.start()
        assert reader.says() == "found"
        until(lambda: wanted(transport, TOPIC_EVENTS), "found here, too")
        for each in packets:
            transport.publish(events_message(each))
        messages = reader.messages()
    until(lambda: transport.status.packets_sent == len(packets), "all are counted")
    transport.stop()
    assert [message["seq_"] for message in messages] == list(range(len(packets)))
    for message, sent in zip(messages, packets, strict=True):
        np.testing.assert_array_equal(decoded(message), sent.events)
        assert (message["width_"], message["height_"], message["is_bigendian_"]) == (346, 260, False)
        assert message["header_"]["frame_id_"] == "davis"
        stamp = message["header_"]["stamp_"]
        assert stamp["sec_"] * 10**9 + stamp["nanosec_"] == sent.time_base_ns == message["time_base_"]


def test_every_event_of_an_array_is_read(tmp_path: Path) -> None:
    transport = Ros2Transport(own_namespace(), "libcaer", LARGEST, "array")
    packets = [packet(seq, 37 * seq % 300) for seq in range(5)]
    topic = f"{transport.namespace}/events"
    with Reader(topic, "EventArray", len(packets), tmp_path / "out") as reader:
        transport.start()
        assert reader.says() == "found"
        until(lambda: wanted(transport, TOPIC_EVENTS), "found here, too")
        for each in packets:
            transport.publish(events_message(each))
        messages = reader.messages()
    transport.stop()
    for message, sent in zip(messages, packets, strict=True):
        stamp = message["header_"]["stamp_"]
        assert stamp["sec_"] * 10**9 + stamp["nanosec_"] == sent.time_base_ns
        assert (message["width_"], message["height_"]) == (346, 260)
        events = [
            (1_000_000 * each["ts_"]["sec_"] + each["ts_"]["nanosec_"] // 1000, each["x_"], each["y_"],
             each["polarity_"])
            for each in message["events_"] or ()
        ]  # fmt: skip
        assert events == sent.events[["t", "x", "y", "p"]].tolist()


def test_a_calibration_is_in_camera_info(tmp_path: Path) -> None:
    k, p = tuple(np.arange(9.0)), tuple(np.arange(12.0))
    intrinsics = Intrinsics((346, 260), "plumb_bob", (0.1, -0.2, 0.0, 1e-3, 0.5), k, k[::-1], p)
    transport = Ros2Transport(own_namespace(), "libcaer", LARGEST, intrinsics=intrinsics)
    with Reader(f"{transport.namespace}/camera_info", "CameraInfo", 1, tmp_path / "infos") as infos:
        transport.start()
        assert infos.says() == "found"
        writer = transport._topics[TOPIC_FRAMES][1][0]
        until(lambda: writer.readers, "found here, too")
        image = np.zeros((260, 346), np.uint8)
        transport.publish(frame_message(FrameMessage(image=image, t_us=START_US, seq=0, stamp_ns=1)))
        (info,) = infos.messages()
    transport.stop()
    assert (info["width_"], info["height_"], info["distortion_model_"]) == (346, 260, "plumb_bob")
    found = [tuple(info[f"{name}_"]) for name in "dkrp"]
    assert found == [intrinsics.distortion, intrinsics.k, intrinsics.r, intrinsics.p]


@pytest.mark.parametrize(
    ("text", "words"),
    [(None, "cannot be read: No such file"), ("a: 1", "is no camera_info file"), (CALIBRATION, "40 x 30")],
)
def test_a_calibration_that_cannot_be_is_one_line(text: str | None, words: str, tmp_path: Path) -> None:
    file = tmp_path / "davis.yaml"
    if text is not None:
        file.write_text(text)
    done = voltcam(
        "serve", "--http", "127.0.0.1:0", "--zmq", "tcp://127.0.0.1:0", "--dv", "off",
        "--ros2", own_namespace(), "--camera-info", str(file),
    )  # fmt: skip
    assert done.returncode == 1
    assert words in done.stderr
    assert str(file) in done.stderr
    assert done.stderr.count("\n") == 1


def test_frames_and_their_camera_info(transport: Ros2Transport, tmp_path: Path) -> None:
    images = np.random.default_rng(1).integers(0, 256, (3, 260, 346), np.uint8)
    with (
        Reader(f"{transport.namespace}/image_raw", "Image", 3, tmp_path / "images") as reader,
        Reader(f"{transport.namespace}/camera_info", "CameraInfo", 3, tmp_path / "infos") as infos,
    ):
        assert reader.says() == infos.says() == "found"
        until(lambda: wanted(transport, TOPIC_FRAMES), "both are found here, too")
        for seq, image in enumerate(images):
            frame = FrameMessage(image=image, t_us=START_US + seq, seq=seq, stamp_ns=1, frame_id="davis")
            transport.publish(frame_message(frame))
        came, said = reader.messages(), infos.messages()
    for seq, (message, info) in enumerate(zip(came, said, strict=True)):
        assert (message["encoding_"], message["step_"]) == ("mono8", 346)
        data = np.frombuffer(bytes.fromhex(message["data_"]), np.uint8)
        np.testing.assert_array_equal(data.reshape(260, 346), images[seq])
        assert info["header_"] == message["header_"]
        assert info["header_"]["stamp_"]["nanosec_"] == 1000 * seq
        assert (info["width_"], info["height_"], info["distortion_model_"]) == (346, 260, "")
    assert len(came) == 3


def test_imu_samples_one_by_one(transport: Ros2Transport, tmp_path: Path) -> None:
    samples = np.zeros(2, IMU)
    samples["t"] = START_US, START_US + 500
    samples["accel_g"], samples["gyro_deg_s"] = (0, -1, 0), (0, 0, 180)
    with Reader(f"{transport.namespace}/imu", "Imu", 2, tmp_path / "out") as reader:
        assert reader.says() == "found"
        until(lambda: wanted(transport, TOPIC_IMU), "found here, too")
        transport.publish(samples_message(TOPIC_IMU, SamplesMessage(samples=samples, seq=0, stamp_ns=1)))
        first, second = reader.messages()
    assert first["linear_acceleration_"] == {"x_": 0.0, "y_": -9.80665, "z_": 0.0}
    assert first["angular_velocity_"]["z_"] == pytest.approx(np.pi)
    assert first["orientation_covariance_"][0] == -1
    assert second["header_"]["stamp_"]["nanosec_"] == 500_000


def test_what_ros2_has_no_message_for_is_left_out(transport: Ros2Transport) -> None:
    triggers = SamplesMessage(samples=np.zeros(1, TRIGGER), seq=0, stamp_ns=1)
    transport.publish(samples_message(TOPIC_TRIGGERS, triggers))
    transport.publish(status_message({}))
    transport.publish(events_message(packet(0, 10)))
    until(lambda: not transport._outbox, "all has been looked at")
    assert (transport.status.packets_sent, transport.status.packets_dropped) == (0, 0)


def test_a_stalled_reader_costs_only_itself(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is reliable, and stopped: all that it would have is more than waits for it."""
    history, count, events = 2**18, 50, 8000
    monkeypatch.setattr(ros2_module, "HISTORY_BYTES", history)
    assert count * 8 * events > 5 * history
    transport = Ros2Transport(own_namespace(), "libcaer", LARGEST)
    transport.start()
    topic = f"{transport.namespace}/events"
    with (
        Reader(topic, "EventPacket", count, tmp_path / "stalled") as stalled,
        Reader(topic, "EventPacket", count, tmp_path / "well", "telling") as well,
    ):
        assert stalled.says() == well.says() == "found"
        until(lambda: wanted(transport, TOPIC_EVENTS, by=2), "both are found here, too")
        os.kill(stalled.process.pid, signal.SIGSTOP)
        for seq in range(count):
            transport.publish(events_message(packet(seq, events)))
            assert well.says() == "one"
        came = [message["seq_"] for message in well.messages()]
        os.kill(stalled.process.pid, signal.SIGCONT)
    assert came == list(range(count))
    assert (transport.status.packets_sent, transport.status.packets_dropped) == (count, 0)
    transport.stop()
    assert transport.failure is None


def test_times_that_have_no_stamp_are_counted_and_told(
    transport: Ros2Transport, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with Reader(f"{transport.namespace}/events", "EventPacket", 1, tmp_path / "out") as reader:
        assert reader.says() == "found"
        until(lambda: wanted(transport, TOPIC_EVENTS), "found here, too")
        empty = np.empty(0, EVENT)
        late = Packet(events=empty, width=4, height=4, seq=0, time_base_ns=2**31 * 10**9, stamp_ns=1)
        transport.publish(events_message(late))
        transport.publish(events_message(packet(1, 3)))
        assert [message["seq_"] for message in reader.messages()] == [1]
    assert transport.status.packets_dropped == 1
    assert "has stamps from 0 to 2^31 s" in caplog.text


def test_a_namespace_that_is_none_is_refused() -> None:
    done = voltcam("serve", "--http", "127.0.0.1:0", "--zmq", "tcp://127.0.0.1:0", "--ros2", "a b")
    assert done.returncode == 1
    assert "command line: ros2: give a namespace of ROS 2, such as dvs, or off" in done.stderr
    assert done.stderr.count("\n") == 1


def test_a_domain_that_is_none_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "999")
    with pytest.raises(UsageError, match="--ros2 dvs: ROS_DOMAIN_ID is '999'"):
        Ros2Transport("dvs", "libcaer", LARGEST)


def test_the_daemon_publishes_where_it_says(tmp_path: Path) -> None:
    namespace = own_namespace()
    with Daemon("--dv", "off", "--ros2", namespace, "--imu", "100") as daemon:
        assert f"ROS 2     /{namespace}/events" in daemon.banner
        assert daemon.get("camera")["ros2"] == f"/{namespace}"
        assert daemon.get("status")["transports"]["ros2"]["address"] == f"/{namespace}, domain {DOMAIN}"
        with (
            Reader(f"/{namespace}/events", "EventPacket", 20, tmp_path / "events") as events,
            Reader(f"/{namespace}/image_raw", "Image", 2, tmp_path / "images") as images,
            Reader(f"/{namespace}/imu", "Imu", 5, tmp_path / "imu") as imu,
        ):
            packets, frames, samples = events.messages(), images.messages(), imu.messages()
        assert daemon.get("status")["transports"]["ros2"]["packets_sent"] >= 20
    assert np.diff([message["seq_"] for message in packets]).tolist() == [1] * 19
    t_us = np.concatenate([decoded(message)["t"] for message in packets])
    assert t_us.size
    assert (np.diff(t_us) >= 0).all()
    assert (len(frames), len(samples)) == (2, 5)
    assert frames[0]["width_"] == 346
