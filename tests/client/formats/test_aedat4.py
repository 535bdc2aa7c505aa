"""`.aedat4` as faery's encoder writes it."""

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from voltcam_client.formats import FormatError, Recording, read
from voltcam_client.formats.aedat4 import decode_aedat4

faery = pytest.importorskip("faery", reason="faery, the oracle, is in the extra [lab]")

START_US = 1_700_000_000_000_000


def write(path: Path, events: np.ndarray) -> None:
    """By faery's encoder, which takes no frames but its decoder's own."""
    aedat = faery.aedat
    attribute = aedat.DescriptionAttribute
    root = "/mainloop/Recorder/outInfo/"
    size = {"sizeX": attribute("int", 346), "sizeY": attribute("int", 260)}
    info = aedat.DescriptionNode("info", f"{root}0/info/", size, [])
    kind = {"compression": attribute("string", "LZ4"), "typeIdentifier": attribute("string", "EVTS")}
    tree = aedat.DescriptionNode("outInfo", root, {}, [aedat.DescriptionNode("0", f"{root}0/", kind, [info])])
    theirs = np.empty(events.size, faery.EVENTS_DTYPE)
    for name, their_name in (("t", "t"), ("x", "x"), ("y", "y"), ("p", "on")):
        theirs[their_name] = events[name]
    with aedat.Encoder(path, [tree], ("lz4", 1)) as encoder:
        for part in np.array_split(theirs, 3):
            encoder.write(0, part)


def frame(begin_us: int, end_us: int, pixels: np.ndarray, t_us: int = 0) -> SimpleNamespace:
    """As faery's decoder gives it."""
    return SimpleNamespace(t=t_us, exposure_start_t=begin_us, exposure_end_t=end_us, pixels=pixels)


@pytest.fixture
def read_frames(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Recording]:
    """read_frames(*frames): the recording that a file of these frames and nothing else gives."""

    def read_them(*frames: SimpleNamespace) -> Recording:
        track = SimpleNamespace(id=1, data_type="frame", dimensions=(346, 260))

        class Decoder(contextlib.nullcontext[None]):
            def __init__(self, _: Path) -> None:
                super().__init__()

            def __enter__(self) -> "Decoder":  # type: ignore[override]
                return self

            def tracks(self) -> list[SimpleNamespace]:
                return [track]

            def __iter__(self) -> Iterator[tuple[SimpleNamespace, SimpleNamespace]]:
                return iter([(track, frame) for frame in frames])

        monkeypatch.setattr(faery.aedat, "Decoder", Decoder)
        (tmp_path / "a.aedat4").touch()
        return decode_aedat4(tmp_path / "a.aedat4")

    return read_them


def test_events(tmp_path: Path, make_events) -> None:
    events = make_events(3000, START_US)
    write(tmp_path / "a.aedat4", events)
    recording = read(tmp_path / "a.aedat4")
    np.testing.assert_array_equal(recording.events, events)
    assert (recording.width, recording.height, recording.frames) == (346, 260, None)


def test_a_frames_time_is_the_middle_of_its_exposure(read_frames) -> None:
    images = np.random.default_rng(3).integers(0, 256, (4, 260, 346), np.uint8)
    begins = [START_US + 40_000 * i for i in range(4)]
    recording = read_frames(*(frame(t, t + 501, image) for t, image in zip(begins, images, strict=True)))
    np.testing.assert_array_equal(recording.frames, images)
    assert recording.exposure_us.tolist() == [[t, t + 501] for t in begins]
    assert recording.frame_t_us.tolist() == [t + 250 for t in begins]
    assert recording.events.size == 0


def test_without_exposures_the_frames_time_counts(read_frames) -> None:
    image = np.zeros((260, 346), np.uint8)
    recording = read_frames(frame(-1, -1, image, 7000), frame(-1, -1, image, 8000))
    assert recording.exposure_us is None
    assert recording.frame_t_us.tolist() == [7000, 8000]


def test_colours_become_luminance(read_frames) -> None:
    red = np.zeros((2, 260, 346, 3), np.uint8)
    red[..., 0] = 255
    assert set(read_frames(frame(0, 9, red[0])).frames.ravel()) == {76}  # 0.299 * 255


def test_frames_of_two_sizes_are_refused(read_frames) -> None:
    with pytest.raises(FormatError, match="frame 1 is 4x2, the first is 346x260: record one size"):
        read_frames(*(frame(0, 9, np.zeros(shape, np.uint8)) for shape in ((260, 346), (2, 4))))


def test_a_file_cut_short(tmp_path: Path, make_events) -> None:
    write(tmp_path / "a.aedat4", make_events(3000))
    data = (tmp_path / "a.aedat4").read_bytes()
    for kept in (0, 3, 20):
        (tmp_path / "cut.aedat4").write_bytes(data[:kept])
        with pytest.raises(FormatError, match=r"cut\.aedat4 is cut short or no AEDAT4 file") as error:
            read(tmp_path / "cut.aedat4")
        assert "\n" not in str(error.value)


def test_a_recording_that_crashed_keeps_what_came_before(street: Path, tmp_path: Path) -> None:
    data = street.read_bytes()
    (tmp_path / "cut.aedat4").write_bytes(data[: len(data) // 2])
    whole, cut = read(street), read(tmp_path / "cut.aedat4")
    assert 0.3 * whole.events.size < cut.events.size < whole.events.size
    np.testing.assert_array_equal(cut.events, whole.events[: cut.events.size])
    np.testing.assert_array_equal(cut.frames, whole.frames[: len(cut.frames)])


def test_a_real_davis346(street: Path) -> None:
    recording = read(street)
    assert (recording.events.size, recording.frames.shape) == (78_830, (59, 260, 346))
    assert set(np.diff(recording.exposure_us).ravel()) == {500}
    theirs = np.concatenate(list(faery.events_stream_from_file(street)))
    np.testing.assert_array_equal(recording.events["t"], theirs["t"])
