import itertools
from pathlib import Path

import cv2
import numpy as np
import pytest

from voltcam_video import SourceError, SourceRequest, open_source
from voltcam_video.photos import PhotoFolder, PhotoScene


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    rng = np.random.default_rng(1)
    for name in ("a.png", "b.png"):
        coarse = rng.integers(0, 255, (6, 8, 3), dtype=np.uint8)
        cv2.imwrite(str(tmp_path / name), cv2.resize(coarse, (80, 60), interpolation=cv2.INTER_CUBIC))
    return tmp_path


def asked(uri: str, **more: object) -> SourceRequest:
    return SourceRequest.model_validate({"uri": uri, "pace": "fast", "width": 32, "height": 24, **more})


def test_frames_are_those_of_the_scene(folder: Path) -> None:
    with open_source(asked(f"photos:{folder}?seed=5&layers=3&speed=40", fps=50)) as source:
        frames = list(itertools.islice(source, 3))
        assert source.endless
        assert source.granted["levels"] == "light"
    scene = PhotoScene(PhotoFolder(folder), 32, 24, layers=3, speed_px_s=40, seed=5)
    assert [frame.t_us for frame in frames] == [0, 20_000, 40_000]
    for frame in frames:
        assert frame.gamma == 1
        np.testing.assert_array_equal(frame.image, scene.frame(frame.t_us))


def test_it_can_begin_later(folder: Path) -> None:
    with open_source(asked(f"photos:{folder}", start_s=3, fps=10)) as source:
        assert [frame.t_us for frame in itertools.islice(source, 2)] == [3_000_000, 3_100_000]


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ("?sed=1", "there is no option 'sed'; there are seed, layers, speed"),
        ("?seed=a", "whole numbers from 0"),
        ("?seed=-1", "whole numbers from 0"),
        ("?layers=0", "1 to 255 layers"),
        ("?layers=2.5", "whole numbers from 0"),
        ("?speed=0", "above 0"),
        ("?speed=nan", "above 0"),
        ("/none", "no such folder"),
    ],
)
def test_what_cannot_be_is_said_in_a_line(folder: Path, options: str, says: str) -> None:
    with pytest.raises(SourceError, match=says) as error:
        open_source(asked(f"photos:{folder}{options}"))
    assert "\n" not in str(error.value)


def test_too_much_is_refused_before_it_is_drawn(folder: Path) -> None:
    with pytest.raises(SourceError, match="too large"):
        open_source(asked(f"photos:{folder}?layers=250", width=4096, height=1000))
    with pytest.raises(SourceError, match="leave --levels video away"):
        open_source(asked(f"photos:{folder}", levels="video"))


def test_a_damaged_photograph_is_named(folder: Path) -> None:
    (folder / "a.png").write_bytes(b"none")
    with pytest.raises(SourceError, match=r"a\.png: no photograph"):
        open_source(asked(f"photos:{folder}"))


def test_a_photograph_s_folder_is_no_recording_of_images(folder: Path) -> None:
    request = SourceRequest(uri=f"photos:{folder}?seed=1")
    assert (request.photo_folder, request.photo_options, request.path) == (folder, "seed=1", None)
    other = SourceRequest(uri="clip?seed=1.mp4")
    assert (other.photo_folder, other.photo_options) == (None, "")
