from collections.abc import Callable
from pathlib import Path

import pytest

from voltcam_video.sources.container import missing_bytes


@pytest.mark.parametrize("name", ["a.mp4", "a.mov", "a.mkv", "a.webm", "a.avi", "fragmented.mp4"])
def test_a_whole_file_misses_nothing_and_a_cut_one_what_was_cut(
    tmp_path: Path, ffmpeg: Callable[..., None], name: str
) -> None:
    path = tmp_path / name
    options = ["-movflags", "frag_keyframe+empty_moov"] if "fragmented" in name else []
    ffmpeg("-f", "lavfi", "-i", "testsrc=size=64x48:rate=25:duration=0.4", *options, path)
    whole = path.read_bytes()
    assert missing_bytes(path) == 0
    path.write_bytes(whole[:-5])
    assert missing_bytes(path) == 5


def test_formats_that_do_not_say_miss_nothing(tmp_path: Path, ffmpeg: Callable[..., None]) -> None:
    path = tmp_path / "a.ts"
    ffmpeg("-f", "lavfi", "-i", "testsrc=size=64x48:rate=25:duration=0.4", path)
    path.write_bytes(path.read_bytes()[:-100])
    assert missing_bytes(path) == 0


def test_a_live_matroska_of_unknown_size_misses_nothing(tmp_path: Path, ffmpeg: Callable[..., None]) -> None:
    path = tmp_path / "live.mkv"
    ffmpeg("-f", "lavfi", "-i", "testsrc=size=64x48:rate=25:duration=0.4", "-live", "1", path)
    path.write_bytes(path.read_bytes()[:-100])
    assert missing_bytes(path) == 0


@pytest.mark.parametrize(
    ("content", "missing"),
    [(b"", 0), (b"\x1a\x45\xdf\xa3", 0), (b"RIFF", 4), (b"\0\0\0\1ftyp", 0), (b"abc", 0)],
)
def test_stubs_do_no_harm(tmp_path: Path, content: bytes, missing: int) -> None:
    path = tmp_path / "stub"
    path.write_bytes(content)
    assert missing_bytes(path) == missing
