"""Bags as rosbags' own deserializer and Debian's `rosbag info` read them."""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from voltcam_client.encodings import decode_libcaer
from voltcam_client.formats import open_writer, read

pytest.importorskip("rosbags", reason="rosbags, the oracle, is in the extra [lab]")
from rosbags.highlevel import AnyReader

EPOCH_US = 1_700_000_000_000_000
KINDS = ("bag", "mcap", "db3")


def write(path: Path, events: np.ndarray) -> None:
    with open_writer(path, width=346, height=260) as writer:
        for number, packet in enumerate(np.array_split(events, 5)):
            writer.events(packet)
            writer.frame(np.full((260, 346), number, np.uint8), int(packet["t"][-1]))


@pytest.mark.parametrize("kind", KINDS)
def test_event_packets_and_images(kind: str, tmp_path: Path, make_events) -> None:
    events = make_events(2000, EPOCH_US)
    write(tmp_path / f"a.{kind}", events)
    parts, images, log_ns = [], [], []
    with AnyReader([tmp_path / f"a.{kind}"]) as bag:
        for connection, t_ns, raw in bag.messages():
            message = bag.deserialize(raw, connection.msgtype)
            stamp_ns = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
            log_ns.append(t_ns)
            assert stamp_ns == t_ns
            if connection.topic == "/dvs/events":
                assert connection.msgtype == "event_camera_msgs/msg/EventPacket"
                assert (message.encoding, message.seq) == ("libcaer", len(parts))
                assert (message.width, message.height, message.time_base) == (346, 260, stamp_ns)
                parts.append(decode_libcaer(message.events.tobytes(), stamp_ns // 1000))
            else:
                assert (connection.topic, message.encoding) == ("/dvs/image_raw", "mono8")
                images.append((stamp_ns // 1000, message.data.reshape(260, 346)[0, 0]))
    assert log_ns == sorted(log_ns)
    np.testing.assert_array_equal(np.concatenate(parts), events)
    assert max(np.ptp(part["t"]) for part in parts) < 10_000
    assert images == [(packet["t"][-1], i) for i, packet in enumerate(np.array_split(events, 5))]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("count", [1, 2, 500])
def test_event_arrays(kind: str, count: int, tmp_path: Path, make_events) -> None:
    events = make_events(count, EPOCH_US)
    path = tmp_path / f"a.dvs.{kind}"
    with open_writer(path, width=346, height=260) as writer:
        writer.events(events)
    rows = []
    with AnyReader([path]) as bag:
        for connection, _, raw in bag.messages():
            message = bag.deserialize(raw, connection.msgtype)
            assert connection.msgtype == "dvs_msgs/msg/EventArray"
            assert (message.width, message.height, message.header.frame_id) == (346, 260, "dvs")
            rows += [(e.ts.sec * 10**6 + e.ts.nanosec // 1000, e.x, e.y, e.polarity) for e in message.events]
    assert rows == events.tolist()


@pytest.mark.parametrize("kind", KINDS)
def test_events_of_one_microsecond_keep_their_order(kind: str, tmp_path: Path, make_events) -> None:
    events = make_events(1000)
    events["t"] = 5
    write(tmp_path / f"a.{kind}", events)
    np.testing.assert_array_equal(read(tmp_path / f"a.{kind}").events, events)


@pytest.mark.parametrize("kind", KINDS)
def test_frames_alone(kind: str, tmp_path: Path) -> None:
    with open_writer(tmp_path / f"a.{kind}", width=346, height=260) as writer:
        writer.frame(np.full((260, 346), 9, np.uint8), EPOCH_US)
    recording = read(tmp_path / f"a.{kind}")
    assert recording.events.size == 0
    assert recording.frame_t_us is not None
    assert recording.frame_t_us.tolist() == [EPOCH_US]


@pytest.mark.parametrize("name", ["a.bag", "a.dvs.bag"])
def test_rosbag_info_of_debian_reads_it(name: str, tmp_path: Path, make_events) -> None:
    rosbag = shutil.which("rosbag")
    if rosbag is None:
        pytest.skip("no rosbag: apt-get install python3-rosbag")
    write(tmp_path / name, make_events(2000, EPOCH_US))
    command = [rosbag, "info", "--yaml", str(tmp_path / name)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    message, digest = (
        ("dvs_msgs/EventArray", "5e8beee5a6c107e504c2e78903c224b8")
        if ".dvs" in name
        else ("event_camera_msgs/EventPacket", "8a6101b351a64529ac77bd8b71074e52")
    )
    assert f"type: {message}" in done.stdout
    assert digest in done.stdout
    assert "topic: /dvs/image_raw" in done.stdout
    assert "messages: 5" in done.stdout
    assert "indexed: True" in done.stdout


def test_a_time_after_ros_is_refused(tmp_path: Path, make_events) -> None:
    with open_writer(tmp_path / "a.mcap", width=346, height=260) as writer:
        with pytest.raises(ValueError, match=r"a\.mcap: ROS has no times after 2\^31 s"):
            writer.events(make_events(1, start_us=2**31 * 10**6))
        writer.events(make_events(1, start_us=5))
    assert read(tmp_path / "a.mcap").events.size == 1
