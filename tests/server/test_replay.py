"""A recording as a live camera, and its events made again."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from voltcam_client.formats import open_writer, read
from voltcam_server.manifest import Manifest, paths_of
from voltcam_server.problems import UsageError
from voltcam_server.recorder import RecordingPlan
from voltcam_server.verify import verify
from voltcam_simulator import EVENT, Camera, Parameters
from voltcam_video import SourceError, SourceRequest

from .rig import Daemon, emulating, in_order, moving_frames, save_frames, tiny, until, voltcam

LIVELY = {"comparator": {"theta_on": 0.3, "theta_off": 0.3}}


def record(path: Path, source: SourceRequest, camera: Camera, **settings: Any) -> None:
    """Some frames, with a change of parameters on the way."""
    with emulating(source, camera, **settings) as (emulator, listener):
        listener.wait(lambda it: len(it.frames) > 20)
        emulator.record(RecordingPlan(path))
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) > count + 10)
        emulator.simulation.change({"temperature_c": 60, "leak_noise": {"k6": 1e-5}})
        listener.wait(lambda it: len(it.frames) > count + 30)
        emulator.end_recording()


def film(folder: Path, camera: Camera) -> SourceRequest:
    """8-bit frames, again and again."""
    uri = save_frames(folder / "film.npz", moving_frames(60, camera))
    return SourceRequest(uri=uri, loop=True)


@pytest.mark.parametrize("upsample", ["off", "auto", 3])
@pytest.mark.parametrize("name", ["davis346", "paper"])
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
        emulator.record(RecordingPlan(tmp_path / "walk.npz"))
        listener.wait(lambda it: len(it.frames) > 30)
        emulator.end_recording()
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


def some_events(count: int = 500) -> np.ndarray[Any, Any]:
    rng = np.random.default_rng(0)
    events = np.empty(count, EVENT)
    events["t"] = np.sort(rng.integers(1_000_000, 1_400_000, count))
    events["x"], events["y"] = rng.integers(0, 24, count), rng.integers(0, 16, count)
    events["p"] = rng.integers(0, 2, count)
    return events


def replay_of(path: Path, **options: Any) -> SourceRequest:
    return SourceRequest(uri=f"replay:{path}", **options)


@pytest.mark.parametrize("suffix", [".npz", ".raw", ".txt"])
def test_a_replay_gives_the_recorded_events_at_their_own_pace(suffix: str, tmp_path: Path) -> None:
    path, events = tmp_path / f"walk{suffix}", some_events()
    with open_writer(path, width=24, height=16) as writer:
        writer.events(events)
    with emulating(replay_of(path), tiny()) as (emulator, listener):
        listener.wait(lambda it: len(it.events) == len(events))
        until(lambda: emulator.state[0] == "ended", "the end")
        assert in_order(listener)
        found = listener.events
    for name in "xyp":
        np.testing.assert_array_equal(found[name], events[name])
    np.testing.assert_array_equal(np.diff(found["t"]), np.diff(events["t"].astype(np.int64)))


def test_a_replay_begins_where_it_is_told_and_goes_round(tmp_path: Path) -> None:
    path, events = tmp_path / "walk.raw", some_events()
    with open_writer(path, width=24, height=16) as writer:
        writer.events(events)
    late = events[events["t"] > events["t"][0] + 300_000]
    with emulating(replay_of(path, start_s=0.3, loop=True), tiny()) as (_, listener):
        listener.wait(lambda it: len(it.events) > len(late) + len(events))
        found = listener.events
        assert in_order(listener)
    # The first frame after the beginning brings the events since the one before, up to 10 ms.
    first = int(np.flatnonzero(np.diff(found["t"].astype(np.int64)) > 0)[0])
    assert first < 40
    tail = np.flatnonzero((events["x"] == found["x"][0]) & (events["y"] == found["y"][0]))
    begin = next(i for i in tail if np.array_equal(events["x"][i:], found["x"][: len(events) - i]))
    assert abs(int(events["t"][begin]) - int(events["t"][0]) - 300_000) < 12_000
    again = found[len(events) - begin :]
    np.testing.assert_array_equal(again["x"][: len(events)], events["x"][: len(again)])


def test_a_replay_needs_a_camera_of_its_size(tmp_path: Path) -> None:
    path = tmp_path / "walk.raw"
    with open_writer(path, width=20, height=16) as writer:
        writer.events(some_events()[:0])
        events = some_events()
        events["x"] %= 20
        writer.events(events)
    with emulating(replay_of(path, loop=True), tiny()) as (emulator, _):
        until(lambda: emulator.status.frames.unusable > 0, "refused")
        assert "20 x 16 pixels needs a camera of that size" in emulator.source.message


def test_what_is_no_recording_is_said(tmp_path: Path) -> None:
    (tmp_path / "empty.raw").write_bytes(b"")
    for name in ("none.npz", "empty.raw"):
        with pytest.raises(SourceError), emulating(replay_of(tmp_path / name), tiny()):
            pass


def test_the_command(tmp_path: Path) -> None:
    path = tmp_path / "walk.npz"
    camera = tiny(**LIVELY)
    record(path, film(tmp_path, camera), camera)
    done = voltcam("replay", str(path), "--verify")
    assert (done.returncode, done.stderr) == (0, "")
    assert "the same bit for bit" in done.stdout
    with Daemon("--loop", command=("replay", str(path))) as daemon:
        camera_now = daemon.get("camera")
        assert (camera_now["width"], camera_now["height"]) == (24, 16)
        until(lambda: daemon.get("status")["events"]["total"] > 100, "events")
        source = daemon.get("source")
        assert source["granted"]["kind"] == "replay"
        request = source["request"] | {"start_s": 0.2}
        assert daemon.http.put("source", json=request).is_success
        until(lambda: (daemon.get("source")["position_s"] or 0) >= 0.2, "the place it was sent to")
