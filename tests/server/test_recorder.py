"""Recordings of what is sent."""

import errno
from pathlib import Path

import numpy as np
import pytest

from voltcam_client.formats import FormatError, RecordingError, read
from voltcam_client.formats.writer import AppendFile
from voltcam_server import recorder as recorder_module
from voltcam_server.manifest import Manifest
from voltcam_server.problems import UsageError
from voltcam_server.recorder import Recorder, RecordingPlan
from voltcam_server.simulation import Simulation
from voltcam_server.verify import verify

from .rig import SCENE, arrival, emulating, moving_frames, slow_disk, tiny, until


def test_a_recording_holds_what_was_sent(tmp_path: Path) -> None:
    path = tmp_path / "out.npz"
    with emulating(SCENE) as (emulator, listener):
        listener.wait(lambda it: it.frames)
        assert emulator.recordings.begin(RecordingPlan(path)).recording
        with pytest.raises(UsageError, match="end that recording first"):
            emulator.recordings.begin(RecordingPlan(tmp_path / "other.npz"))
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) >= count + 20)
        done = emulator.recordings.end()
        assert (done.recording, done.error) == (False, None)
        with pytest.raises(RecordingError, match="exists already"):
            emulator.recordings.begin(RecordingPlan(path))
        with pytest.raises(FormatError, match="suffix"):
            emulator.recordings.begin(RecordingPlan(tmp_path / "out.mp3"))
        count = len(listener.frames)  # a recorded interval may still wait for its turn to be sent
        listener.wait(lambda it: len(it.frames) >= count + 20)
    recording = read(path)
    assert recording.frames is not None
    assert recording.frame_t_us is not None
    assert (done.events, done.frames) == (recording.events.size, len(recording.frames))
    assert len(recording.frames) >= 9
    first, last = recording.frame_t_us[0], recording.frame_t_us[-1]
    # All intervals that end at a recorded frame, and no other; the first began before its first frame.
    sent = [frame.t_us for frame in listener.frames]
    begin = sent[sent.index(first) - 1]
    assert sent[sent.index(first) : sent.index(last) + 1] == recording.frame_t_us.tolist()
    packets = [p for p in listener.packets if begin <= p.time_base_ns // 1000 < last]
    np.testing.assert_array_equal(recording.events, np.concatenate([p.events for p in packets]))


def test_a_full_disk_ends_the_recording_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "out.txt"
    with emulating(SCENE) as (emulator, listener):
        listener.wait(lambda it: it.frames)
        emulator.recordings.begin(RecordingPlan(path))
        until(lambda: emulator.status.recording.events > 100, "events are recorded")  # type: ignore[union-attr]

        def full(*_: object) -> None:
            raise OSError(errno.ENOSPC, "No space left on device")

        monkeypatch.setattr(AppendFile, "append", full)
        until(lambda: not emulator.status.recording.recording, "the recording ends")  # type: ignore[union-attr]
        status = emulator.status.recording
        assert status is not None
        assert status.error is not None
        assert "No space left" in status.error
        assert "\n" not in status.error
        with pytest.raises(RecordingError, match="exists already"):
            emulator.recordings.begin(RecordingPlan(path))
        # The stream goes on without a recorder.
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) >= count + 100)
        with pytest.raises(UsageError, match="nothing is being recorded"):
            emulator.recordings.end()
    assert read(path).events.size == status.events > 100


def test_ending_the_daemon_finishes_the_recording(tmp_path: Path) -> None:
    path = tmp_path / "out.npz"
    with emulating(SCENE) as (emulator, listener):
        emulator.recordings.begin(RecordingPlan(path))
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) > count + 20)
    assert verify(path).difference == ""
    assert Manifest.read(path).end["ended"] == "it was ended"
    recording = read(path)
    assert recording.frame_t_us is not None
    # The emulator's listener and its recorder stop one after the other: the frames of one go on in the other.
    sent, kept = [frame.t_us for frame in listener.frames], recording.frame_t_us.tolist()
    assert len(kept) > 10
    common = [t_us for t_us in sent if t_us >= kept[0]]
    assert common == kept[: len(common)]


def test_a_slow_disk_never_holds_the_stream(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What does not fit into the queue is lost and counted; no file has a gap, and each can be made again."""
    monkeypatch.setattr(recorder_module, "QUEUE_BYTES", 20_000)
    go = slow_disk(monkeypatch)
    with emulating(SCENE) as (emulator, listener):
        listener.wait(lambda it: it.frames)
        emulator.recordings.begin(RecordingPlan(tmp_path / "out.npz"))
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) > count + 150)
        status = emulator.status.recording
        assert status is not None
        assert status.lost_intervals > 50
        go.set()
        until(lambda: emulator.status.recording.files == 2, "the next file has begun")  # type: ignore[union-attr]
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) > count + 20)
        done = emulator.recordings.end()
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) > count + 5)
        sent = [frame.t_us for frame in listener.frames]
    assert done.error is None
    for name in ("out.npz", "out-002.npz"):
        frame_t_us = read(tmp_path / name).frame_t_us
        assert frame_t_us is not None
        first = sent.index(frame_t_us[0])
        assert sent[first : first + len(frame_t_us)] == frame_t_us.tolist()
        assert verify(tmp_path / name).difference == ""


def test_files_are_rotated_by_time_and_by_size(tmp_path: Path) -> None:
    with emulating(SCENE) as (emulator, listener):
        listener.wait(lambda it: it.frames)
        for name, plan in (
            ("time", RecordingPlan(tmp_path / "time.npz", rotate_s=0.3)),
            ("size", RecordingPlan(tmp_path / "size.npz", rotate_bytes=20_000)),
        ):
            emulator.recordings.begin(plan)
            until(lambda: emulator.status.recording.files >= 3, name)  # type: ignore[union-attr]
            done = emulator.recordings.end()
            assert (done.error, done.lost_intervals) == (None, 0)
            files = [tmp_path / f"{name}.npz", *sorted(tmp_path.glob(f"{name}-*.npz"))]
            assert files[1].name == f"{name}-002.npz"
            recordings = [read(file) for file in files if "state" not in file.name]
            assert sum(each.events.size for each in recordings) == done.events
            times = np.concatenate([each.frame_t_us for each in recordings if each.frame_t_us is not None])
            count = len(listener.frames)
            listener.wait(lambda it, count=count: len(it.frames) > count + 5)
            sent = [frame.t_us for frame in listener.frames]
            assert sent[sent.index(times[0]) : sent.index(times[-1]) + 1] == times.tolist()


def test_files_whose_suffix_has_two_parts_are_numbered_before_it(tmp_path: Path) -> None:
    with emulating(SCENE) as (emulator, listener):
        listener.wait(lambda it: it.frames)
        emulator.recordings.begin(RecordingPlan(tmp_path / "out.evt2.raw", rotate_s=0.2))
        until(lambda: emulator.status.recording.files >= 2, "the next file")  # type: ignore[union-attr]
        done = emulator.recordings.end()
    assert (done.error, done.left_out) == (None, "without frames, which .evt2.raw cannot carry")
    files = sorted(tmp_path.glob("*.evt2.raw"))
    assert {"out-002.evt2.raw", "out.evt2.raw"} <= {file.name for file in files}
    assert all(file.read_bytes().startswith(b"% evt 2.0") for file in files)


def test_a_recording_ends_before_the_disk_is_full(tmp_path: Path) -> None:
    with emulating(SCENE) as (emulator, listener):
        listener.wait(lambda it: it.frames)
        emulator.recordings.begin(RecordingPlan(tmp_path / "out.npz", least_free_bytes=10**18))
        until(lambda: emulator.status.recording.error, "it ends")  # type: ignore[union-attr]
        assert "least_free_bytes keeps" in str(emulator.status.recording)
        assert emulator.status.recording_errors == 1
    assert read(tmp_path / "out.npz").frames is not None


def test_a_file_that_is_full_takes_what_comes_until_the_next_can_begin(tmp_path: Path) -> None:
    """It may become full while an interval is made, and the state before that interval was not kept."""
    camera = tiny()
    simulation = Simulation(camera, "exact", 0)
    images = moving_frames(4, camera)
    recorder = Recorder(RecordingPlan(tmp_path / "out.npz", rotate_bytes=1), simulation.setup)
    for index, (image, looked) in enumerate(zip(images, (True, False, True, True), strict=True)):
        if looked:
            recorder.look(simulation, "here")
        interval = simulation.step(arrival(image, 10_000 * index))
        assert interval is not None
        recorder.put(interval)
        until(lambda count=index + 1: recorder.status.frames == count, "it is written")
    recorder.close()
    assert recorder.status.lost_intervals == 0
    files = [tmp_path / name for name in ("out.npz", "out-002.npz", "out-003.npz")]
    assert [verify(file).frames for file in files] == [2, 1, 1]
    assert not any(verify(file).difference for file in files)
