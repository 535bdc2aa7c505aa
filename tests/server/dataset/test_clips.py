"""Inputs one by one: their names, their seeds, and what is opened."""

from pathlib import Path

import numpy as np
import pytest
from tests.server.dataset.rig import clip, image_folder, spec

from voltcam_server.dataset.clips import clips_of, items_of, seed_of
from voltcam_server.problems import UsageError
from voltcam_video import SourceError
from voltcam_video.sources.images import ImagesSource


def test_a_name_is_the_path_below_the_fixed_part_of_the_pattern(tmp_path: Path) -> None:
    for name in ("a/one.npz", "a/two.npz", "b/one.npz"):
        clip(tmp_path / "in" / name)
    assert [one.name for one in clips_of(spec(tmp_path, f"{tmp_path}/in/**/*.npz"))] == [
        "a/one.npz", "a/two.npz", "b/one.npz"
    ]  # fmt: skip
    assert [one.name for one in clips_of(spec(tmp_path, f"{tmp_path}/in/a/one.npz"))] == ["one.npz"]
    named = spec(tmp_path, {"files": f"{tmp_path}/in/a/*", "name": "first"})
    assert [one.name for one in clips_of(named)] == ["first/one.npz", "first/two.npz"]


def test_a_seed_is_the_name_s_and_the_variant_s() -> None:
    seeds = {seed_of(seed, name, variant) for seed in (0, 1) for name in ("a", "b") for variant in (0, 1, 11)}
    assert len(seeds) == 12
    assert all(0 <= seed < 2**63 for seed in seeds)


def test_names_that_are_one_are_refused(tmp_path: Path) -> None:
    for name in ("a/one.npz", "b/one.npz", "c/x/y.npz", "c/x-y.npz"):
        clip(tmp_path / "in" / name)
    inputs = [f"{tmp_path}/in/a/*.npz", f"{tmp_path}/in/b/*.npz"]
    with pytest.raises(UsageError, match=r"are both one\.npz: give one of the inputs a `name`"):
        clips_of(spec(tmp_path, inputs))
    both = spec(tmp_path, f"{tmp_path}/in/c/**/*.npz")
    with pytest.raises(UsageError, match=r"x/y\.npz and x-y\.npz would both be x-y\.npz"):
        items_of(both, clips_of(both))
    clip(tmp_path / "in" / "d" / f"{'n' * 210}.npz")
    long = spec(tmp_path, f"{tmp_path}/in/d/*")
    with pytest.raises(UsageError, match="the name is too long for a file"):
        items_of(long, clips_of(long))


def test_a_pattern_that_finds_nothing_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"in/\*\.mp4 finds nothing: correct the pattern, or fill"):
        clips_of(spec(tmp_path, f"{tmp_path}/in/*.mp4"))
    (tmp_path / "in").mkdir()
    with pytest.raises(UsageError, match="in is empty: fill the folder"):
        clips_of(spec(tmp_path, f"{tmp_path}/in"))
    clip(tmp_path / "in" / "one.npz")
    with pytest.raises(UsageError, match=r"only \{stem\}, \{name\} and \{folder\} are known"):
        clips_of(spec(tmp_path, {"files": f"{tmp_path}/in/*", "labels": "labels/{stam}"}))


def test_images_without_times_take_those_that_are_given(tmp_path: Path) -> None:
    folder = image_folder(tmp_path / "in" / "walk", 12)
    (folder / "stamps.txt").write_text("# seconds\n" + "".join(f"{0.5 + i / 8}\n" for i in range(12)))
    for given, period_us, first_us in (
        ({"fps": 50}, 20_000, 0),
        ({"stamps": "stamps.txt"}, 125_000, 500_000),
    ):
        [one] = clips_of(spec(tmp_path, {"files": f"{tmp_path}/in/*"} | given))
        with one.open(24, 16) as source:
            assert source.levels == "video"
            frames = list(source)
        assert [frame.t_us for frame in frames] == [first_us + period_us * i for i in range(12)]
        starts = [int(np.argmax(frame.image[0] > 100)) for frame in frames]
        assert starts[:9] == [2 * i for i in range(9)], "2.png comes before 10.png"
    [bare] = clips_of(spec(tmp_path, f"{tmp_path}/in/*"))
    with pytest.raises(SourceError, match=r"no images\.txt in this folder"):
        bare.open(24, 16)


def test_a_list_of_the_folder_s_own_comes_before_a_rate(tmp_path: Path) -> None:
    folder = image_folder(tmp_path / "in" / "walk", 3)
    (folder / "images.txt").write_text("0.5 0.png\n0.7 1.png\n")
    (folder / "events.txt").write_text("")
    [one] = clips_of(spec(tmp_path, {"files": f"{tmp_path}/in/*", "fps": 50}))
    with one.open(24, 16) as source:
        assert isinstance(source, ImagesSource)
        assert source.levels == "light", "beside events they are a camera's own"
        assert [frame.t_us for frame in source] == [500_000, 700_000]


def test_a_folder_called_scene_is_not_the_built_in_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    image_folder(tmp_path / "scene", 3)
    monkeypatch.chdir(tmp_path)
    [one] = clips_of(spec(tmp_path, {"files": "scene"}))
    with pytest.raises(SourceError, match=r"no images\.txt"):
        one.open(24, 16)
