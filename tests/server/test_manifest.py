"""What stands beside a recording: how it was made, line by line."""

import hashlib
import json
import platform
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from voltcam_client.formats import open_writer, read
from voltcam_server.interval import Interval, SimulationSetup, Start
from voltcam_server.manifest import Manifest, ManifestWriter, paths_of, software
from voltcam_server.problems import UsageError
from voltcam_server.verify import verify
from voltcam_simulator import EVENT, Parameters

from .rig import LIVELY, film, record, tiny


def test_the_manifest_says_how_it_was_made(tmp_path: Path) -> None:
    path = tmp_path / "walk.npz"
    camera = tiny(**LIVELY)
    record(path, film(tmp_path, camera), camera, seed=5)
    manifest = Manifest.read(path)
    assert manifest.head["seed"] == 5
    assert manifest.head["source"].endswith("film.npz")
    assert manifest.head["parameters"]["comparator"]["theta_on"] == 0.3
    (changed,) = [note for note in manifest.notes.values() if "parameters" in note]
    assert changed["parameters"]["temperature_c"] == 60
    recording = read(path)
    assert manifest.end["events"] == recording.events.size
    assert manifest.end["ended"] == "it was ended"


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "only recordings of a daemon"),
        ("", "no manifest"),
        ("[1]\n", "no manifest"),
        ('{"manifest": 9}', "format 9"),
    ],
)
def test_what_is_no_manifest_is_said(content: str | None, words: str, tmp_path: Path) -> None:
    path = tmp_path / "walk.npz"
    with open_writer(path, width=4, height=4) as writer:
        writer.frame(np.zeros((4, 4), np.uint8), 0)
    if content is not None:
        paths_of(path)[0].write_text(content)
    with pytest.raises(UsageError, match=words):
        verify(path)


def setup() -> SimulationSetup:
    return SimulationSetup(tiny(), "exact", 5, "off")


def begun(parameters: Parameters, **state: np.ndarray) -> Start:
    return Start(state, False, parameters, 3, "rtsp://me:***@cam/")


def interval(count: int, parameters: Parameters, **changes: Any) -> Interval:
    events = np.zeros(count, EVENT)
    events["x"] = np.arange(count)
    image = np.zeros((16, 24), np.uint8)
    usual = Interval(events, 0, 10, 10, image, parameters, 3, "advanced", 1.0, 0.0, 0.0, True)
    return replace(usual, **changes)


def lines(recording: Path) -> list[dict[str, Any]]:
    """As a program that knows JSON only reads them."""
    return [json.loads(line) for line in paths_of(recording)[0].read_text().splitlines()]


def test_only_what_is_not_as_always_has_a_line(tmp_path: Path) -> None:
    path, parameters = tmp_path / "walk.npz", Parameters()
    warm = parameters.changed({"temperature_c": 60})
    writer = ManifestWriter(path, setup(), begun(parameters))
    writer.interval(interval(3, parameters))
    writer.interval(interval(2, parameters, how="jumped", frame_us=20))
    writer.interval(interval(0, parameters, coarser=2.0))
    writer.interval(interval(4, warm, parameters_version=4, frame_us=40))
    writer.interval(interval(1, warm, parameters_version=4))
    head, jumped, coarser, changed = lines(path)  # each line is there before the end
    assert (head["seed"], head["law"], head["width"], head["height"]) == (5, "exact", 24, 16)
    assert (head["source"], head["parameters_version"]) == ("rtsp://me:***@cam/", 3)
    assert Parameters.model_validate(head["parameters"]) == parameters
    assert jumped == {"frame": 1, "t_us": 20, "how": "jumped", "coarser": 1.0}
    assert coarser == {"frame": 2, "t_us": 10, "how": "advanced", "coarser": 2.0}
    assert (changed["frame"], changed["parameters_version"]) == (3, 4)
    assert Parameters.model_validate(changed["parameters"]) == warm
    writer.close(10, "it was ended")
    manifest = Manifest.read(path)
    assert set(manifest.notes) == {1, 2, 3}
    assert (manifest.end["frames"], manifest.end["events"]) == (5, 10)


def test_the_checksum_is_sha256_of_the_events_as_they_lie_in_memory(tmp_path: Path) -> None:
    path, parameters = tmp_path / "walk.npz", Parameters()
    writer = ManifestWriter(path, setup(), begun(parameters))
    parts = [interval(count, parameters) for count in (3, 0, 5)]
    for part in parts:
        writer.interval(part)
    writer.close(8, "it was ended")
    whole = np.concatenate([part.events for part in parts])
    assert Manifest.read(path).end["sha256"] == hashlib.sha256(whole.tobytes()).hexdigest()


def test_after_a_crash_there_is_no_end(tmp_path: Path) -> None:
    path, parameters = tmp_path / "walk.npz", Parameters()
    ManifestWriter(path, setup(), begun(parameters)).interval(interval(1, parameters, how="jumped"))
    assert Manifest.read(path).end == {}


def test_the_state_is_a_numpy_file(tmp_path: Path) -> None:
    path = tmp_path / "walk.npz"
    ManifestWriter(path, setup(), begun(Parameters(), voltage=np.arange(4)))
    with np.load(paths_of(path)[1], allow_pickle=False) as state:
        assert {name: state[name].tolist() for name in state.files} == {"voltage": [0, 1, 2, 3]}


def test_frames_finer_than_8_bit_are_beside_it_and_those_of_another_recording_are_gone(
    tmp_path: Path,
) -> None:
    path, parameters = tmp_path / "walk.npz", Parameters()
    fine = np.linspace(0, 255, 16 * 24, dtype=np.float32).reshape(16, 24)
    writer = ManifestWriter(path, setup(), begun(parameters))
    for image in (fine, fine[::-1]):
        writer.interval(interval(0, parameters, image=image))
    writer.close(0, "it was ended")
    kept = np.fromfile(paths_of(path)[2], np.float32).reshape(2, 16, 24)
    np.testing.assert_array_equal(kept, [fine, fine[::-1]])
    ManifestWriter(path, setup(), begun(parameters)).interval(interval(0, parameters))
    assert not paths_of(path)[2].exists()


def test_software_is_what_is_installed() -> None:
    assert software()["numpy"] == np.__version__
    assert software()["python"] == platform.python_version()


def test_files_are_beside_the_recording() -> None:
    names = [path.name for path in paths_of(Path("/a/walk.npz"))]
    assert names == ["walk.npz.manifest.jsonl", "walk.npz.state.npz", "walk.npz.frames32"]
    assert {path.parent for path in paths_of(Path("/a/walk.npz"))} == {Path("/a")}
