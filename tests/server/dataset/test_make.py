"""A whole set: the same bytes in any order, resumed where it was, what cannot be made told and left out."""

import errno
import json
import shutil
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from tests.server.dataset.rig import FRAMES, HereEngine, clip, clips, content, image_folder, made, spec

from voltcam_client.formats import hdf5_writer, read
from voltcam_server.dataset import item as item_module
from voltcam_server.dataset.clips import Item
from voltcam_server.dataset.item import Making
from voltcam_server.dataset.manifest import locked, read_manifest
from voltcam_server.problems import UsageError
from voltcam_simulator import Camera, Simulator

DRAWN = {"comparator": {"theta_on": {"uniform": [0.2, 0.4]}, "theta_off": 0.3}}


def test_items_are_what_a_simulator_gives_with_the_drawn_camera_and_seed(tmp_path: Path) -> None:
    wanted = spec(
        tmp_path, f"{clips(tmp_path / 'in', 2)}/*.npz", variants=2, parameters=DRAWN, levels="light"
    )
    done = made(wanted.model_copy(update={"upsample": "linear"}), tmp_path / "set")
    assert (done.made, done.failed, done.left) == (4, 0, 0)
    lines = read_manifest(tmp_path / "set")
    assert [(line["name"], line["variant"]) for line in lines] == [
        ("clip0.npz", 0), ("clip0.npz", 1), ("clip1.npz", 0), ("clip1.npz", 1)
    ]  # fmt: skip
    assert len({line["seed"] for line in lines}) == 4
    assert len({line["drawn"]["comparator.theta_on"] for line in lines}) == 4
    for line in lines:
        recording = read(tmp_path / "set" / line["path"])
        frames = np.load(tmp_path / "in" / line["name"])
        camera = Camera.from_mapping({"width": line["width"], "height": line["height"]} | line["parameters"])
        simulator = Simulator(24, 16, camera.parameters, seed=line["seed"])
        alone = list(simulator.stream(zip(frames["frames"], frames["t_us"].tolist(), strict=True)))
        assert np.array_equal(recording.events, np.concatenate(alone))
        assert line["events"] == len(recording.events) > 0
        assert line["on"] == np.count_nonzero(recording.events["p"])
        assert np.array_equal(recording.frames, frames["frames"])
        assert np.array_equal(recording.frame_t_us, frames["t_us"])
        assert line["frames"] == FRAMES


@pytest.mark.parametrize("suffix", [".h5", ".aedat4", ".npz"])
def test_any_order_gives_the_same_bytes(tmp_path: Path, suffix: str) -> None:
    wanted = spec(tmp_path, f"{clips(tmp_path / 'in', 3)}/*", format=suffix, parameters=DRAWN)
    made(wanted, tmp_path / "one")
    made(wanted, tmp_path / "other", HereEngine(reverse=True))
    assert content(tmp_path / "one") == content(tmp_path / "other")
    assert len(content(tmp_path / "one")) == 3 + 2


def test_an_item_does_not_depend_on_what_else_is_in_the_set(tmp_path: Path) -> None:
    folder = clips(tmp_path / "in", 3)
    made(spec(tmp_path, f"{folder}/*", parameters=DRAWN), tmp_path / "all")
    made(spec(tmp_path, f"{folder}/clip2*", parameters=DRAWN), tmp_path / "one")
    name = "items/clip2.npz.0.h5"
    assert (tmp_path / "all" / name).read_bytes() == (tmp_path / "one" / name).read_bytes()


def test_what_was_stopped_goes_on_and_repeats_nothing(tmp_path: Path) -> None:
    wanted = spec(tmp_path, f"{clips(tmp_path / 'in', 5)}/*", parameters=DRAWN)
    whole = made(wanted, tmp_path / "whole")
    first, second = HereEngine(stop_after=2, reverse=True), HereEngine()
    stopped = made(wanted, tmp_path / "set", first)
    assert (stopped.made, stopped.left, stopped.ended) == (2, 3, "it was stopped")
    assert "3 are left: the same command goes on" in stopped.words
    # As a crash leaves it: half a line, an item under way, and one whose line is not written yet.
    with (tmp_path / "set" / "manifest.jsonl").open("a") as file:
        file.write('{"name": "clip0')
    (tmp_path / "set" / ".aside" / "tmpx").mkdir(parents=True)
    (tmp_path / "set" / "items" / "clip0.npz.0.h5").write_bytes(b"half")
    going_on = made(wanted, tmp_path / "set", second)
    assert (going_on.made, going_on.before, going_on.left) == (3, 2, 0)
    assert not set(first.done) & set(second.done)
    assert whole.events == stopped.events + going_on.events
    assert content(tmp_path / "set") == content(tmp_path / "whole")
    again = HereEngine()
    assert made(wanted, tmp_path / "set", again).before == 5
    assert again.done == []


def test_inputs_may_come_later_and_another_spec_may_not(tmp_path: Path) -> None:
    folder = clips(tmp_path / "in", 2)
    wanted = spec(tmp_path, f"{folder}/*", parameters=DRAWN)
    made(wanted, tmp_path / "set")
    clip(folder / "late.npz", 9)
    assert made(wanted, tmp_path / "set").made == 1
    more = wanted.model_copy(update={"variants": 2})
    assert made(more, tmp_path / "set").made == 3
    before = content(tmp_path / "set")
    other = spec(tmp_path, f"{folder}/*", parameters={"comparator": {"theta_on": 0.5}})
    with pytest.raises(UsageError, match=r"was begun with another spec, items/clip0.* give another folder"):
        made(other, tmp_path / "set")
    Path(wanted.camera[0]).write_text("name: tiny\nwidth: 24\nheight: 16\ntemperature_c: 40\n")
    with pytest.raises(UsageError, match="was begun with another spec"):
        made(wanted, tmp_path / "set")
    assert content(tmp_path / "set") == before


def test_what_cannot_be_made_is_told_listed_and_tried_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = clips(tmp_path / "in", 2)
    (folder / "bad.mp4").write_text("no video")
    clip(folder / "short.npz", count=1)
    done = made(spec(tmp_path, f"{folder}/*"), tmp_path / "set")
    assert (done.made, done.failed) == (2, 2)
    said = [line for line in capsys.readouterr().err.splitlines() if line.startswith("voltcam: ")]
    assert len(said) == 2
    assert "bad.mp4: not a video ffmpeg can read" in said[0]
    assert "short.npz has one frame: events need two, give a longer one" in said[1]
    failed = [line for line in read_manifest(tmp_path / "set") if "failed" in line]
    assert [line["name"] for line in failed] == ["bad.mp4", "short.npz"]
    clip(folder / "short.npz")
    assert made(spec(tmp_path, f"{folder}/*"), tmp_path / "set").made == 1
    assert [line["name"] for line in read_manifest(tmp_path / "set") if "failed" in line] == ["bad.mp4"]


def test_one_that_breaks_while_it_is_made_does_not_stop_the_rest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = clips(tmp_path / "in", 3)
    whole = item_module._written

    def broken(item: Item, making: Making, path: Path) -> Any:
        if item.clip.name == "clip1.npz":
            raise ValueError("of no\nuse")
        return whole(item, making, path)

    monkeypatch.setattr(item_module, "_written", broken)
    done = made(spec(tmp_path, f"{folder}/*"), tmp_path / "set")
    assert (done.made, done.failed, done.left) == (2, 1, 0)
    assert read_manifest(tmp_path / "set")[1]["failed"] == "of no use"
    assert not (tmp_path / "set" / ".aside").exists()


def test_a_full_disk_ends_it_and_the_same_command_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wanted = spec(tmp_path, f"{clips(tmp_path / 'in', 4)}/*")
    with monkeypatch.context() as patch:
        count = 0
        whole = hdf5_writer.Hdf5Writer._assemble

        def full(*arguments: Any) -> None:
            nonlocal count
            count += 1
            if count > 2:
                raise OSError(errno.ENOSPC, "No space left on device")
            whole(*arguments)

        patch.setattr(hdf5_writer.Hdf5Writer, "_assemble", full)
        done = made(wanted, tmp_path / "set")
    assert (done.made, done.failed, done.left) == (2, 0, 2)
    assert "the disk is full: " in done.ended
    assert len(read_manifest(tmp_path / "set")) == 2
    assert made(wanted, tmp_path / "set").made == 2
    made(wanted, tmp_path / "whole")
    assert content(tmp_path / "set") == content(tmp_path / "whole")


def test_too_little_space_is_said_before_anything_is_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    usage = shutil.disk_usage(tmp_path)._replace(free=1000)
    monkeypatch.setattr("voltcam_server.dataset.space.shutil.disk_usage", lambda _: usage)
    with pytest.raises(UsageError, match=r"takes about 0 MB, and 0 MB are free: make room"):
        made(spec(tmp_path, f"{clips(tmp_path / 'in', 4)}/*"), tmp_path / "set")
    assert content(tmp_path / "set") == {}


def test_two_do_not_make_one_set(tmp_path: Path) -> None:
    (tmp_path / "set").mkdir()
    with locked(tmp_path / "set"), pytest.raises(UsageError, match="another program makes this set"):
        made(spec(tmp_path, f"{clips(tmp_path / 'in', 1)}/*"), tmp_path / "set")


def test_shards_are_folders_of_so_many(tmp_path: Path) -> None:
    made(spec(tmp_path, f"{clips(tmp_path / 'in', 5)}/*", shard=2), tmp_path / "set")
    folders = [line["path"].split("/")[1] for line in read_manifest(tmp_path / "set")]
    assert folders == ["00000", "00000", "00001", "00001", "00002"]


def test_labels_and_tables_go_along_with_their_times(tmp_path: Path) -> None:
    image_folder(tmp_path / "in" / "walk", 12)
    image_folder(tmp_path / "labels" / "walk", 12)
    (tmp_path / "boxes").mkdir()
    (tmp_path / "boxes" / "walk.csv").write_text("frame,x,y\n0,1,2\n3,4,5\n11,9,9\n")
    inputs = {
        "files": str(tmp_path / "in" / "*"), "fps": 100,
        "labels": str(tmp_path / "labels" / "{stem}"), "table": str(tmp_path / "boxes" / "{stem}.csv"),
    }  # fmt: skip
    made(spec(tmp_path, inputs, seconds=0.05), tmp_path / "set")
    with np.load(tmp_path / "set" / "items" / "walk.0.h5.labels.npz") as beside:
        recording = read(tmp_path / "set" / "items" / "walk.0.h5")
        assert np.array_equal(beside["labels"], recording.frames), "here the labels are the frames"
        assert np.array_equal(beside["t_us"], recording.frame_t_us)
        assert beside["t_us"].tolist() == [0, 10_000, 20_000, 30_000, 40_000, 50_000]
    table = (tmp_path / "set" / "items" / "walk.0.h5.table.csv").read_text()
    assert table == "t_us,frame,x,y\n0,0,1,2\n30000,3,4,5\n"
    [line] = read_manifest(tmp_path / "set")
    assert sorted(line["sha256"]) == [
        "items/walk.0.h5", "items/walk.0.h5.labels.npz", "items/walk.0.h5.table.csv"
    ]  # fmt: skip


def test_scenes_of_photographs_are_clips_of_the_sensor_s_size(tmp_path: Path) -> None:
    image_folder(tmp_path / "photographs", 3)
    inputs = {"files": str(tmp_path / "photographs"), "scenes": 2, "fps": 100, "speed": 200, "truth": True}
    done = made(spec(tmp_path, inputs, seconds=0.05, variants=2, parameters=DRAWN), tmp_path / "set")
    assert (done.made, done.failed) == (4, 0)
    lines = read_manifest(tmp_path / "set")
    assert [line["name"] for line in lines[::2]] == ["photographs/scene-000000", "photographs/scene-000001"]
    truths = []
    for line in lines:
        recording = read(tmp_path / "set" / line["path"])
        assert recording.frame_t_us is not None
        with h5py.File(tmp_path / "set" / f"{line['path']}.truth.h5") as file:
            assert np.array_equal(file["t_us"], recording.frame_t_us)
            assert np.array_equal(np.rint(file["light"]), recording.frames)
            truths.append(np.array(file["flow"]))
        assert line["levels"] == "light"
        assert line["frames"] == 6
    assert np.array_equal(truths[0], truths[1]), "variants are of one scene"
    assert not np.array_equal(truths[0], truths[2])
    with pytest.raises(UsageError, match="test: scenes do not end by themselves: give seconds"):
        spec(tmp_path, inputs)


def test_items_without_frames_have_none(tmp_path: Path) -> None:
    made(spec(tmp_path, f"{clips(tmp_path / 'in', 1)}/*", frames=False), tmp_path / "set")
    with h5py.File(tmp_path / "set" / "items" / "clip0.npz.0.h5") as file:
        assert "frames" not in file
        assert len(file["events/t"]) > 0


def test_nothing_that_can_be_used_is_an_error(tmp_path: Path) -> None:
    clip(tmp_path / "in" / "short.npz", count=1)
    with pytest.raises(UsageError, match="no input can be used, see the lines above"):
        made(spec(tmp_path, f"{tmp_path}/in/*"), tmp_path / "set")


def test_the_manifest_has_nothing_of_a_clock(tmp_path: Path) -> None:
    made(spec(tmp_path, f"{clips(tmp_path / 'in', 1)}/*"), tmp_path / "set")
    [line] = (tmp_path / "set" / "manifest.jsonl").read_text().splitlines()
    assert set(json.loads(line)) == {
        "begin_us", "bytes", "camera", "digest", "drawn", "events", "events_per_s", "frames", "height",
        "levels", "name", "on", "parameters", "path", "seconds", "seed", "sha256", "software", "source",
        "source_height", "source_width", "variant", "width",
    }  # fmt: skip
