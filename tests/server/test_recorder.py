"""Recordings of what is sent."""

import errno
from pathlib import Path

import numpy as np
import pytest

from voltcam_client.formats import FormatError, RecordingError, read
from voltcam_server.problems import UsageError
from voltcam_server.recorder import QUEUE_INTERVALS

from .rig import (
    SCENE,
    emulating,
    until,
)


def test_a_recording_holds_what_was_sent(tmp_path: Path) -> None:
    path = tmp_path / "out.npz"
    with emulating(SCENE) as (emulator, listener):
        listener.wait(lambda it: it.frames)
        assert emulator.record(str(path)).recording
        with pytest.raises(UsageError, match="end that recording first"):
            emulator.record(str(tmp_path / "other.npz"))
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) >= count + 10)
        done = emulator.end_recording()
        assert (done.recording, done.error) == (False, None)
        with pytest.raises(RecordingError, match="exists already"):
            emulator.record(str(path))
        with pytest.raises(FormatError, match="suffix"):
            emulator.record(str(tmp_path / "out.mp3"))
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
        emulator.record(str(path))
        recorder = emulator._recorder
        assert recorder is not None
        until(lambda: recorder.status.events > 100, "events are recorded")

        def full(*_: object) -> None:
            raise OSError(errno.ENOSPC, "No space left on device")

        monkeypatch.setattr(type(recorder._writer), "_append", full)
        until(lambda: not recorder.status.recording, "the recording ends")
        status = emulator.status.recording
        assert status is not None
        assert status.error is not None
        assert "No space left" in status.error
        assert "\n" not in status.error
        with pytest.raises(RecordingError, match="exists already"):
            emulator.record(str(path))  # the stream goes on without a recorder: more frames than one holds
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) >= count + QUEUE_INTERVALS + 5)
        with pytest.raises(UsageError, match="nothing is being recorded"):
            emulator.end_recording()
    assert read(path).events.size == status.events > 100


def test_ending_the_daemon_finishes_the_recording(tmp_path: Path) -> None:
    path = tmp_path / "out.npz"
    with emulating(SCENE) as (emulator, listener):
        emulator.record(str(path))
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) > count + 10)
    assert read(path).events.size > 0
