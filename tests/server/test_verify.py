"""The events of a recording made again from its frames, bit for bit, or the first difference."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from voltcam_client.formats import read
from voltcam_server.interval import Interval, SimulationSetup
from voltcam_server.manifest import paths_of
from voltcam_server.problems import UsageError
from voltcam_server.recorder import RecordingPlan
from voltcam_server.recording_file import RecordingFile
from voltcam_server.simulation import Simulation
from voltcam_server.verify import Verdict, verify
from voltcam_simulator import Camera, Parameters
from voltcam_video import SourceRequest

from .rig import LIVELY, arrival, emulating, film, moving_frames, record, tiny


@pytest.mark.parametrize("upsample", ["off", "auto", 3])
@pytest.mark.parametrize("name", ["typical", "paper"])
def test_a_recording_is_made_again_bit_for_bit(name: str, upsample: Any, tmp_path: Path) -> None:
    camera = Camera(name="tiny", width=24, height=16, parameters=Parameters.of(name).changed(LIVELY))
    path = tmp_path / "walk.npz"
    record(path, film(tmp_path, camera), camera, seed=7, upsample=upsample)
    verdict = verify(path)
    recording = read(path)
    assert recording.frames is not None
    assert (verdict.difference, verdict.versions) == ("", {})
    assert verdict.frames == len(recording.frames) >= 30
    assert verdict.events == recording.events.size > 300


def test_frames_finer_than_8_bit_are_kept_for_it(tmp_path: Path) -> None:
    path, camera = tmp_path / "walk.npz", tiny(**LIVELY)
    fine = moving_frames(60, camera).astype(np.float32) + 0.3
    np.savez(tmp_path / "film.npz", frames=fine, t_us=10_000 * np.arange(60))
    record(path, SourceRequest(uri=str(tmp_path / "film.npz"), loop=True), camera)
    assert paths_of(path)[2].exists()
    assert verify(path).difference == ""


def test_a_recording_from_the_first_frame_on(tmp_path: Path) -> None:
    """There is no state before it."""
    camera = tiny(**LIVELY)
    with emulating(film(tmp_path, camera), camera) as (emulator, listener):
        emulator.recordings.begin(RecordingPlan(tmp_path / "walk.npz"))
        listener.wait(lambda it: len(it.frames) > 30)
        emulator.recordings.end()
    assert verify(tmp_path / "walk.npz").difference == ""


@pytest.mark.parametrize("column", ["t", "x", "p"])
def test_an_event_that_was_changed_is_found(column: str, tmp_path: Path) -> None:
    path = tmp_path / "walk.npz"
    camera = tiny(**LIVELY)
    record(path, film(tmp_path, camera), camera)
    with np.load(path) as file:
        content = dict(file)
    middle = content["t"].size // 2
    content[column][middle] = content[column][middle] ^ 1
    content["t"].sort()
    np.savez(path, **content)
    verdict = verify(path)
    assert "events differ" in verdict.difference
    assert 0 < verdict.events < content["t"].size


def test_a_state_of_another_voltcam_is_refused(tmp_path: Path) -> None:
    """Its arbiter kept what waits under another name."""
    path = tmp_path / "walk.npz"
    camera = tiny(**LIVELY, readout={"row_us": 1})
    record(path, film(tmp_path, camera), camera)
    kept = paths_of(path)[1]
    with np.load(kept) as file:
        content = dict(file)
    content["state/readout/columns"] = content.pop("state/readout/waiting")
    with kept.open("wb") as opened:
        np.savez(opened, **content)
    with pytest.raises(UsageError, match=r"is of another Voltcam: verify walk\.npz with the one"):
        verify(path)


def test_other_software_is_named(tmp_path: Path) -> None:
    path = tmp_path / "walk.npz"
    camera = tiny(**LIVELY)
    record(path, film(tmp_path, camera), camera)
    manifest = paths_of(path)[0]
    first, *rest = manifest.read_text().splitlines()
    head = json.loads(first)
    head["software"]["numpy"] = "1.0"
    manifest.write_text("\n".join([json.dumps(head), *rest]))
    verdict = verify(path)
    assert verdict.versions["numpy"] == ("1.0", np.__version__)
    assert f"numpy 1.0, now {np.__version__}" in verdict.words


def recorded(path: Path, cuts: tuple[int, ...] = ()) -> list[Interval]:
    """Eight frames simulated and recorded in this thread, with jumps at `cuts`."""
    camera = tiny(**LIVELY)
    simulation = Simulation(camera, "exact", 3)
    file = RecordingFile(path, SimulationSetup(camera, "exact", 3, "off"))
    intervals = []
    for i, image in enumerate(moving_frames(8, camera)):
        start = simulation.start_of("film.npz") if i == 0 else None
        interval = simulation.step(arrival(image, 10_000 * i, cut=i in cuts))
        assert interval is not None
        file.write(start, interval)
        intervals.append(interval)
    file.end("it was ended")
    file.wait()
    return intervals


def rewrite(path: Path, index: int, **changes: Any) -> None:
    """Change a line of a recording's manifest."""
    manifest = paths_of(path)[0]
    lines = [json.loads(line) for line in manifest.read_text().splitlines()]
    lines[index] |= changes
    manifest.write_text("".join(json.dumps(line) + "\n" for line in lines))


def test_jumps_are_made_again_too(tmp_path: Path) -> None:
    intervals = recorded(tmp_path / "a.npz", cuts=(4,))
    assert [interval.how for interval in intervals].count("jumped") == 2
    verdict = verify(tmp_path / "a.npz")
    assert (verdict.frames, verdict.difference) == (8, "")
    assert verdict.events == sum(interval.events.size for interval in intervals) > 100


def test_a_seed_that_is_not_the_recorded_one_is_found(tmp_path: Path) -> None:
    recorded(tmp_path / "a.npz")
    rewrite(tmp_path / "a.npz", 0, seed=4)
    assert "events differ" in verify(tmp_path / "a.npz").difference


def test_what_was_given_up_ends_it(tmp_path: Path) -> None:
    """From a longer step to a given-up one: what came before still counts."""
    intervals = recorded(tmp_path / "a.npz", cuts=(5,))
    rewrite(tmp_path / "a.npz", 2, how="given up")
    verdict = verify(tmp_path / "a.npz")
    assert "frame 5 was given up" in verdict.difference
    assert verdict.frames == 5
    assert verdict.events == sum(interval.events.size for interval in intervals[:5])


def test_what_cannot_be_made_again_is_said(tmp_path: Path) -> None:
    recorded(tmp_path / "a.npz")
    rewrite(tmp_path / "a.npz", 0, upsample="cubic")
    with pytest.raises(UsageError, match="--upsample cubic, which needs frames"):
        verify(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as file:
        content = {name: file[name] for name in file.files if name not in ("frames", "frame_t_us", "t_us")}
    np.savez(tmp_path / "a.npz", **content)
    with pytest.raises(UsageError, match=r"has no frames to make its events from: record \.npz"):
        verify(tmp_path / "a.npz")


def test_a_verdict_in_words() -> None:
    same = Verdict(3, 50, "", {})
    assert same.words == "50 events of 3 frames made again, the same bit for bit"
    other = Verdict(
        1, 5, "from frame 1 on events differ", {"numpy": ("1.0", "2.0"), "numba": ("0.1", "none")}
    )
    assert other.words.endswith(
        "; from frame 1 on events differ; made with numpy 1.0, now 2.0, numba 0.1, now none"
    )
