import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from voltcam_video import Frame, SourceError, SourceRequest, open_source

Ffmpeg = Callable[..., None]
TEST_PICTURE = ("-f", "lavfi", "-i", "testsrc=size=160x120:rate=25:duration=2")
# Frame n is all grey 40 + 4 n: the order of the frames can be seen.
RISING = ("-f", "lavfi", "-i", "color=gray:size=64x48:rate=25:duration=1.2,geq=lum=40+4*N:cb=128:cr=128")


def read_fast(path: Path) -> tuple[list[int], list[np.ndarray]]:
    with open_source(SourceRequest(uri=str(path), pace="fast")) as source:
        frames = list(source)
    return [frame.t_us for frame in frames], [frame.image for frame in frames]


def probe(path: Path) -> list[dict[str, str]]:
    """ffprobe's own account of the frames, in the order shown."""
    command = ["ffprobe", "-v", "error", "-select_streams", "v", "-show_entries", "frame=pts_time,pict_type"]
    found = subprocess.run([*command, "-of", "json", path], capture_output=True, check=True, timeout=60)
    frames: list[dict[str, str]] = json.loads(found.stdout)["frames"]
    return frames


def probed_times_us(path: Path) -> list[int]:
    return [round(float(frame["pts_time"]) * 1e6) for frame in probe(path)]


@pytest.mark.parametrize("name", ["vfr.mp4", "vfr.mkv", "vfr.webm"])
def test_variable_frame_rate_keeps_every_frames_own_time(tmp_path: Path, ffmpeg: Ffmpeg, name: str) -> None:
    path = tmp_path / name
    ffmpeg(*TEST_PICTURE, "-vf", "setpts='(N+N*N/20)/25/TB'", "-vsync", "vfr", "-b:v", "200k", path)
    times_us, _ = read_fast(path)
    assert len(set(np.diff(times_us))) > 2
    np.testing.assert_allclose(times_us, probed_times_us(path), atol=1)


def test_b_frames_come_in_the_order_shown(tmp_path: Path, ffmpeg: Ffmpeg) -> None:
    path = tmp_path / "b.mp4"
    ffmpeg(*RISING, "-c:v", "libx264", "-bf", "3", "-x264-params", "b-adapt=0", "-crf", "10", path)
    assert sum(frame["pict_type"] == "B" for frame in probe(path)) > 5
    times_us, images = read_fast(path)
    assert times_us == [40_000 * i for i in range(30)] == probed_times_us(path)
    means = [image.mean() for image in images]
    assert (np.diff(means) > 2).all()


def test_granted_says_what_the_file_is(tmp_path: Path, ffmpeg: Ffmpeg) -> None:
    path = tmp_path / "clip.mp4"
    ffmpeg(*TEST_PICTURE, "-c:v", "libx264", path)
    with open_source(SourceRequest(uri=str(path))) as source:
        granted = source.granted
    assert (granted["kind"], granted["live"], granted["clock"]) == ("file", False, "recording")
    assert (granted["width"], granted["height"], granted["fps"], granted["frames"]) == (160, 120, 25, 50)


@pytest.mark.parametrize("name", ["raw.h264", "bframes.avi"])
def test_frames_without_a_stamp_follow_at_the_nominal_rate(tmp_path: Path, ffmpeg: Ffmpeg, name: str) -> None:
    path = tmp_path / name
    ffmpeg(*TEST_PICTURE, "-bf", "2", path)
    times_us, _ = read_fast(path)
    assert len(times_us) == 50
    assert set(np.diff(times_us)) == {40_000}


def test_frame_size_may_change_in_the_middle(tmp_path: Path, ffmpeg: Ffmpeg) -> None:
    parts = []
    for width, offset in ((160, 0), (320, 0.4)):
        part = tmp_path / f"{width}.ts"
        picture = f"color=gray:size={width}x120:rate=25:duration=0.4,geq=lum='255*gte(X,W/2)':cb=128:cr=128"
        ffmpeg("-f", "lavfi", "-i", picture, "-c:v", "mpeg2video", "-output_ts_offset", str(offset), part)
        parts.append(part.read_bytes())
    path = tmp_path / "both.ts"
    path.write_bytes(b"".join(parts))
    _, images = read_fast(path)
    assert len(images) >= 19  # the decoder keeps the last of the first part
    for image in images:  # whole and to scale, whichever size OpenCV gives it
        assert image[:, : image.shape[1] // 2 - 8].mean() < 10
        assert image[:, image.shape[1] // 2 + 8 :].mean() > 245


def test_times_that_go_back_are_named(tmp_path: Path, ffmpeg: Ffmpeg) -> None:
    part, path = tmp_path / "part.ts", tmp_path / "twice.ts"
    ffmpeg(*TEST_PICTURE, part)
    path.write_bytes(part.read_bytes() * 2)
    with pytest.raises(SourceError, match=r"twice\.ts: frame 5\d is at \d+ us, not later than .* ffmpeg -i"):
        read_fast(path)


@pytest.mark.parametrize("name", ["half.mp4", "half.mkv", "half.avi"])
def test_a_truncated_file_gives_what_it_has_and_then_says_so(
    tmp_path: Path, ffmpeg: Ffmpeg, name: str, capfd: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / name
    ffmpeg(*TEST_PICTURE, "-c:v", "mpeg4", *(["-movflags", "+faststart"] if "mp4" in name else []), path)
    path.write_bytes(path.read_bytes()[: path.stat().st_size * 2 // 3])
    with open_source(SourceRequest(uri=str(path), pace="fast")) as source:
        frames: list[Frame] = []
        with pytest.raises(SourceError, match="ended early") as error:
            frames.extend(source)
        assert 10 < len(frames) < 50
        assert f"{name}: ended early, {len(frames)} frames read of 50 announced" in str(error.value)
        assert source.read() is None
    assert capfd.readouterr() == ("", "")


def test_whole_files_that_announce_too_much_are_not_called_truncated(tmp_path: Path, ffmpeg: Ffmpeg) -> None:
    offset, cut = tmp_path / "offset.mkv", tmp_path / "cut.mp4"
    ffmpeg(*TEST_PICTURE, "-output_ts_offset", "5", offset)
    assert len(read_fast(offset)[0]) == 50
    ffmpeg(*TEST_PICTURE, "-c:v", "libx264", "-g", "10", tmp_path / "whole.mp4")
    ffmpeg("-ss", "0.5", "-i", tmp_path / "whole.mp4", "-c", "copy", cut)
    assert len(read_fast(cut)[0]) >= 37


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "the file is empty"),
        (bytes(range(256)) * 40, "not a video ffmpeg can read"),
        (
            b"\0\0\0\x20ftypisom" + b"\0" * 20 + b"\0\1\0\0mdat" + b"x" * 50,
            "cut short, 65478 bytes",
        ),
    ],
)
def test_what_is_no_video_is_named(
    tmp_path: Path, content: bytes, message: str, capfd: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "clip.mp4"
    path.write_bytes(content)
    with pytest.raises(SourceError, match=message) as error:
        open_source(SourceRequest(uri=str(path)))
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)
    assert capfd.readouterr() == ("", "")


def test_a_missing_file_says_what_a_source_can_be(tmp_path: Path) -> None:
    with pytest.raises(SourceError, match=r"none\.mp4: no such file; a source is scene, a camera"):
        open_source(SourceRequest(uri=str(tmp_path / "none.mp4")))


def test_a_looped_file_runs_on(tmp_path: Path, ffmpeg: Ffmpeg) -> None:
    path = tmp_path / "clip.mp4"
    ffmpeg(*RISING, path)
    with open_source(SourceRequest(uri=str(path), pace="fast", loop=True)) as source:
        frames = [source.read() for _ in range(65)]
    assert [frame.t_us for frame in frames if frame] == [40_000 * i for i in range(65)]
    assert [i for i, frame in enumerate(frames) if frame and frame.cut] == [30, 60]
