"""One file of a recording: what is in it, what it counts, and why it could not be finished."""

from pathlib import Path

import numpy as np
import pytest

from voltcam_client.formats import FormatError, RecordingError, read
from voltcam_server.beside import DavisSettings
from voltcam_server.interval import Interval
from voltcam_server.manifest import Manifest, ManifestWriter
from voltcam_server.problems import UsageError
from voltcam_server.recording_file import RecordingFile
from voltcam_server.simulation import Simulation
from voltcam_server.verify import verify

from .rig import LIVELY, arrival, moving_frames, tiny


def recorded(
    path: Path, frames: int = 4, davis: DavisSettings | None = None
) -> tuple[RecordingFile, list[Interval]]:
    """Frames 10 ms apart, simulated and written; not finished."""
    camera = tiny(**LIVELY, aps_coupling={"frame_period_us": 5000, "row_us": 10})
    simulation, intervals = Simulation(camera, "exact", 3, davis=davis), []
    file = RecordingFile(path, simulation.setup)
    assert not file.begun
    for i, image in enumerate(moving_frames(frames, camera)):
        start = simulation.start_of("here") if i == 0 else None
        interval = simulation.step(arrival(image, 10_000 * i))
        assert interval is not None
        file.write(start, interval)
        intervals.append(interval)
    return file, intervals


@pytest.mark.parametrize("suffix", [".npz", ".raw", ".aedat4"])
def test_it_holds_and_counts_what_was_written(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"a{suffix}"
    file, intervals = recorded(path)
    events = np.concatenate([interval.events for interval in intervals])
    images = sum(interval.image.size for interval in intervals) if suffix != ".raw" else 0
    assert file.begun
    assert (file.events, file.frames) == (events.size, 0 if suffix == ".raw" else 4)
    assert file.size_bytes == events.nbytes + images
    assert file.span_s == 0.03
    file.end("it was ended")
    file.end("again does no harm")
    file.wait()
    recording = read(path)
    np.testing.assert_array_equal(recording.events, events)
    assert Manifest.read(path).end["ended"] == "it was ended"
    if suffix == ".npz":
        assert recording.frame_t_us is not None
        assert recording.frame_t_us.tolist() == [0, 10_000, 20_000, 30_000]


@pytest.mark.parametrize("suffix", [".npz", ".aedat4"])
def test_aps_frames_are_recorded_with_their_exposures(suffix: str, tmp_path: Path) -> None:
    """160 us of reset, 500 us of exposure, each 5 ms. Its events cannot be made again from them."""
    path = tmp_path / f"a{suffix}"
    file, intervals = recorded(path, davis=DavisSettings(frames="aps", imu_hz=1000, triggers_hz=100))
    file.end("it was ended")
    file.wait()
    recording = read(path)
    assert recording.exposure_us is not None
    assert recording.exposure_us.tolist() == [[160 + 5000 * i, 660 + 5000 * i] for i in range(6)]
    assert file.frames == 6
    assert recording.frames is not None
    expected = [frame.image for interval in intervals for frame in interval.beside.frames]
    np.testing.assert_array_equal(recording.frames, expected)
    with pytest.raises(UsageError, match=r"no frames of its source .* record --frames source"):
        verify(path)


def test_imu_and_triggers_are_recorded_where_the_format_holds_them(tmp_path: Path) -> None:
    dv = pytest.importorskip("dv_processing", reason="dv-processing, the oracle, is not installed")
    file, _ = recorded(tmp_path / "a.aedat4", davis=DavisSettings(imu_hz=1000, triggers_hz=100))
    file.end("it was ended")
    file.wait()
    theirs = dv.io.MonoCameraRecording(str(tmp_path / "a.aedat4"))
    samples = theirs.getImuTimeRange(0, 30_001)
    assert [each.timestamp for each in samples] == list(range(1000, 30_001, 1000))
    triggers = theirs.getTriggersTimeRange(0, 30_001)
    assert [each.timestamp for each in triggers] == list(range(5000, 30_001, 5000))


def test_an_npz_needs_as_much_again_to_be_put_together(tmp_path: Path) -> None:
    file, _ = recorded(tmp_path / "a.npz")
    file.size_bytes = 10**18
    assert file.free_bytes < 0
    file.end("it was ended")
    file.wait()
    assert file.free_bytes > 0
    text, _ = recorded(tmp_path / "a.raw")
    text.size_bytes = 10**18
    assert text.free_bytes > 0
    text.end("it was ended")
    text.wait()


def test_one_that_never_began_leaves_no_manifest(tmp_path: Path) -> None:
    file = RecordingFile(tmp_path / "a.raw", Simulation(tiny(), "exact", 0).setup)
    file.end("it was ended")
    file.wait()
    assert [path.name for path in tmp_path.iterdir()] == ["a.raw"]


def test_a_name_that_will_not_do_is_refused_at_once(tmp_path: Path) -> None:
    setup = Simulation(tiny(), "exact", 0).setup
    (tmp_path / "a.npz").touch()
    with pytest.raises(RecordingError, match="exists already"):
        RecordingFile(tmp_path / "a.npz", setup)
    with pytest.raises(FormatError, match="suffix"):
        RecordingFile(tmp_path / "a.mp3", setup)


def test_why_it_could_not_be_finished_is_said_to_who_waits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    file, _ = recorded(tmp_path / "a.raw")
    with monkeypatch.context() as patch:
        patch.setattr(ManifestWriter, "close", full)
        file.end("it was ended")
        with pytest.raises(RecordingError, match=r"a\.raw: No space left on device: its manifest has no end"):
            file.wait()
    assert read(tmp_path / "a.raw").events.size == file.events
    file._writer.close()
    assert file._manifest is not None
    file._manifest.close(0, "the test is over")
