"""Recording a running camera."""

import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from voltcam_client import VoltcamError
from voltcam_client.formats import read
from voltcam_client.packet import TOPIC_FRAMES
from voltcam_client.record import Progress, record
from voltcam_client.samples import (
    IMU,
    TOPIC_IMU,
    TOPIC_TRIGGERS,
    TRIGGER,
    SamplesMessage,
    encode_samples,
)


def record_what(
    publisher: Any, path: Path, send: Callable[[], None], until_events: int, **options: Any
) -> Progress:
    """Record what `send` sends once the recorder has subscribed, until that many events are in."""
    seen = [0]

    def run() -> None:
        publisher.wait_for_subscribers()
        send()

    thread = threading.Thread(target=run)
    thread.start()
    deadline = time.monotonic() + 20
    try:
        return record(
            publisher.url,
            path,
            stop=lambda: seen[0] >= until_events or time.monotonic() > deadline,
            show=lambda progress: seen.__setitem__(0, progress.events),
            **options,
        )
    finally:
        thread.join(10)


@pytest.mark.parametrize("suffix", [".npz", ".raw", ".csv", ".txt", ".aedat4"])
def test_every_event_is_in_the_file(publisher: Any, make_packet: Any, tmp_path: Path, suffix: str) -> None:
    packets = [make_packet(seq, 50) for seq in range(40)]
    path = tmp_path / f"run{suffix}"
    progress = record_what(publisher, path, lambda: publisher.send(*packets), 2000, frames=False)
    assert (progress.events, progress.frames, progress.lost_packets) == (2000, 0, 0)
    np.testing.assert_array_equal(read(path).events, np.concatenate([packet.events for packet in packets]))


def test_imu_and_triggers_are_recorded_where_the_format_holds_them(
    publisher: Any, make_packet: Any, tmp_path: Path
) -> None:
    dv = pytest.importorskip("dv_processing", reason="dv-processing, the oracle, is not installed")
    path = tmp_path / "run.aedat4"
    imu = np.array([(7, 25.5, (0, -1, 0), (1, 2, 3))], IMU)
    triggers = np.array([(5, 1), (8, 2)], TRIGGER)

    def send() -> None:
        publisher.send(make_packet(0))
        for topic, samples in ((TOPIC_IMU, imu), (TOPIC_TRIGGERS, triggers)):
            publisher.wait_for_subscribers(topic)
            message = SamplesMessage(samples=samples, seq=0, stamp_ns=1)
            publisher.send_raw(topic, *encode_samples(message))
        for seq in range(1, 100):
            publisher.send(make_packet(seq))
            time.sleep(0.002)  # so that the samples, which come on their own connection, are not too late

    record_what(publisher, path, send, 1000)
    recording = dv.io.MonoCameraRecording(str(path))
    assert [each.timestamp for each in recording.getNextImuBatch()] == [7]
    assert [each.timestamp for each in recording.getNextTriggerBatch()] == [5, 8]


def test_frames_are_recorded_with_their_times(
    publisher: Any, make_packet: Any, make_frame: Any, tmp_path: Path
) -> None:
    path = tmp_path / "run.npz"

    def send() -> None:
        publisher.send(make_packet(0))  # the recorder asks for frames when it has the first packet
        publisher.wait_for_subscribers(TOPIC_FRAMES)
        publisher.send(make_frame(1), make_frame(2))
        for seq in range(1, 100):
            publisher.send(make_packet(seq))
            time.sleep(0.002)  # so that the frames, which come on their own connection, are not too late

    progress = record_what(publisher, path, send, 1000)
    recording = read(path)
    assert progress.frames == 2
    assert recording.frames is not None
    assert recording.frame_t_us is not None
    assert recording.frame_t_us.tolist() == [1000, 2000]
    assert recording.frames[:, 0, 0].tolist() == [1, 2]
    assert (recording.width, recording.height) == (40, 30)


def test_seconds_count_from_the_first_packet(running_camera: str, tmp_path: Path) -> None:
    progress = record(running_camera, tmp_path / "run.raw", seconds=0.5)
    assert progress.seconds == pytest.approx(0.5, abs=0.3)
    assert progress.events > 0
    assert read(tmp_path / "run.raw").events.size == progress.events


def test_no_camera_no_file(tmp_path: Path) -> None:
    with pytest.raises(TimeoutError, match="nothing is recorded: is `voltcam serve` running there"):
        record("tcp://127.0.0.1:1", tmp_path / "run.npz", seconds=0.2)
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_exists_is_kept(running_camera: str, tmp_path: Path) -> None:
    (tmp_path / "run.raw").write_bytes(b"precious")
    with pytest.raises(OSError, match="exists already"):
        record(running_camera, tmp_path / "run.raw", seconds=5)
    assert (tmp_path / "run.raw").read_bytes() == b"precious"
    record(running_camera, tmp_path / "run.raw", seconds=0.1, overwrite=True)
    assert read(tmp_path / "run.raw").events.size > 0


@pytest.mark.parametrize(
    ("change", "said"),
    [({"width": 50}, "is now 50x30, not 40x30"), ({"t_us": 0}, "was started anew, its clock went back")],
)
def test_a_camera_that_was_started_anew_ends_the_recording_and_keeps_it(
    publisher: Any, make_packet: Any, tmp_path: Path, change: dict[str, int], said: str
) -> None:
    path = tmp_path / "run.raw"
    packets = [make_packet(5), make_packet(6), make_packet(7, **change)]
    with pytest.raises(
        VoltcamError, match=f"{publisher.url} {said}.*{path} holds what came before"
    ) as caught:
        record_what(publisher, path, lambda: publisher.send(*packets), 1000)
    assert "\n" not in str(caught.value)
    np.testing.assert_array_equal(
        read(path).events, np.concatenate([packet.events for packet in packets[:2]])
    )
