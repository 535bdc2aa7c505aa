"""What clips are cut from."""

from pathlib import Path

import cv2
import numpy as np
import pytest

pytest.importorskip("torch", reason="PyTorch is not installed: pip install 'voltcam[learn]'")

from voltcam_lab.torch import EventClips, Photographs, Videos
from voltcam_video import SourceError

SPAN_US = 100_000


@pytest.fixture
def video(tmp_path: Path) -> Path:
    """100 frames of 40 x 30, 10 ms apart: a pixel's light tells its place and time."""
    t, y, x = np.indices((100, 30, 40))
    np.savez(
        tmp_path / "walk.npz",
        frames=(t + y / 100 + x / 10_000).astype(np.float32),
        t_us=10_000 * np.arange(100),
    )
    return tmp_path / "walk.npz"


def test_a_piece_of_a_video_is_cut_in_time_and_space(video: Path) -> None:
    rng = np.random.default_rng(1)
    begins, corners = set(), set()
    for _ in range(20):
        frames = list(Videos([video]).clip(8, 6, SPAN_US, rng))
        assert len(frames) == 11
        assert frames[-1].t_us - frames[0].t_us == SPAN_US
        t, place = divmod(float(frames[0].image[0, 0]), 1)
        top, left = round(place * 100 // 1), round(place * 10_000) % 100
        for i, frame in enumerate(frames):
            y, x = np.indices((6, 8))
            np.testing.assert_allclose(frame.image, t + i + (top + y) / 100 + (left + x) / 10_000, atol=1e-4)
        begins.add(t)
        corners.add((top, left))
    assert len(begins) > 10
    assert len(corners) > 10


def test_the_same_numbers_cut_the_same_piece(video: Path) -> None:
    a, b = (list(Videos([video]).clip(8, 6, SPAN_US, np.random.default_rng(5))) for _ in range(2))
    assert [frame.t_us for frame in a] == [frame.t_us for frame in b]
    assert all(np.array_equal(one.image, other.image) for one, other in zip(a, b, strict=True))


def test_clips_of_videos_are_simulated(video: Path) -> None:
    clips = EventClips(Videos([video]), "davis346", width=8, height=6, windows=4, window_us=20_000, clips=2)
    assert [item["images"].shape for item in clips] == [(4, 6, 8)] * 2


def test_what_is_too_small_or_too_short_is_named(video: Path) -> None:
    rng = np.random.default_rng(1)
    with pytest.raises(SourceError, match="40 x 30, smaller than a clip of 64 x 6"):
        list(Videos([video]).clip(64, 6, SPAN_US, rng))
    with pytest.raises(SourceError, match="shorter than a clip of 2 s"):
        list(Videos([video]).clip(8, 6, 2_000_000, rng))


def test_a_folder_s_photographs_are_read_once(tmp_path: Path) -> None:
    for name in "abc":
        cv2.imwrite(str(tmp_path / f"{name}.png"), np.full((20, 30), 90, np.uint8))
    scenery = Photographs(tmp_path, 32, 24)
    first = [frame.image for frame in scenery.clip(8, 6, 20_000, np.random.default_rng(1))]
    for _ in range(10):  # by now all have been looked at
        list(scenery.clip(8, 6, 1_000, np.random.default_rng(2)))
    for path in tmp_path.iterdir():
        path.unlink()
    again = [frame.image for frame in scenery.clip(8, 6, 20_000, np.random.default_rng(1))]
    assert all(map(np.array_equal, first, again))


def test_speeds_are_drawn_from_their_range() -> None:
    light = [np.random.default_rng(1).uniform(0, 255, (60, 80)).astype(np.float32)]
    rng = np.random.default_rng(1)

    def change(speed: tuple[float, float]) -> float:
        return float(
            np.mean(
                [
                    np.abs(
                        np.diff(
                            [
                                f.image
                                for f in Photographs(light, 20, 16, speed_px_s=speed).clip(
                                    16, 12, 10_000, rng
                                )
                            ],
                            axis=0,
                        )
                    ).mean()
                    for _ in range(8)
                ]
            )
        )

    assert change((200, 400)) > 3 * change((10, 20))


def test_a_clip_is_cut_from_the_scene_and_not_larger() -> None:
    with pytest.raises(ValueError, match="40 x 8 is larger than a scene of 32 x 24"):
        next(Photographs([np.ones((4, 4), np.float32)], 32, 24).clip(40, 8, 10, np.random.default_rng(1)))


@pytest.mark.parametrize("wrong", [{"speed_px_s": (0, 1)}, {"speed_px_s": (2, 1)}, {"fps": 0}])
def test_impossible_scenes_are_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(ValueError, match="above 0"):
        Photographs([np.ones((4, 4), np.float32)], **wrong)  # type: ignore[arg-type]
