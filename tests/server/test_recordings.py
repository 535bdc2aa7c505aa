"""One recording of a camera at a time, begun and ended."""

from pathlib import Path

import pytest

from voltcam_client.formats import read
from voltcam_server import recordings as recordings_module
from voltcam_server.problems import UsageError
from voltcam_server.recorder import RecordingPlan

from .rig import SCENE, emulating, slow_disk, until


def test_ending_a_recording_waits_no_longer_than_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What the disk has not taken by then is written all the same; no other recording begins meanwhile."""
    monkeypatch.setattr(recordings_module, "FINISH_S", 0.05)
    path, go = tmp_path / "out.npz", slow_disk(monkeypatch)
    with emulating(SCENE) as (emulator, listener):
        listener.wait(lambda it: it.frames)
        emulator.recordings.begin(RecordingPlan(path))
        until(lambda: emulator.status.waiting.recording > 5, "some intervals wait")
        for _ in range(2):
            ending = emulator.recordings.end()
            assert (ending.recording, ending.ending, ending.frames) == (False, True, 0)
        with pytest.raises(UsageError, match="still being written"):
            emulator.recordings.begin(RecordingPlan(tmp_path / "other.npz"))
        go.set()
        until(lambda: not emulator.status.recording.ending, "all is written")  # type: ignore[union-attr]
        done = emulator.recordings.end()
        assert (done.recording, done.ending, done.error) == (False, False, None)
        assert emulator.status.recording is None
    recording = read(path)
    assert recording.frames is not None
    assert len(recording.frames) == done.frames > 5
    assert recording.events.size == done.events
