"""`.aedat4` as faery's encoder writes it."""

import importlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from backports import zstd

from voltcam_client.dv.file import MAGIC, PACKET
from voltcam_client.dv.packets import events_packet, frame_packet
from voltcam_client.dv.streams import DvStream, header_bytes
from voltcam_client.encodings import EVENT
from voltcam_client.formats import FormatError, Recording, read

faery = pytest.importorskip("faery", reason="faery, the oracle, is not installed")

START_US = 1_700_000_000_000_000


def write(
    path: Path, events: np.ndarray, name: str = "LZ4", compression: tuple[str, int] = ("lz4", 1)
) -> None:
    """By faery's encoder, which takes no frames but its decoder's own."""
    aedat = faery.aedat
    attribute = aedat.DescriptionAttribute
    root = "/mainloop/Recorder/outInfo/"
    size = {"sizeX": attribute("int", 346), "sizeY": attribute("int", 260)}
    info = aedat.DescriptionNode("info", f"{root}0/info/", size, [])
    kind = {"compression": attribute("string", name), "typeIdentifier": attribute("string", "EVTS")}
    tree = aedat.DescriptionNode("outInfo", root, {}, [aedat.DescriptionNode("0", f"{root}0/", kind, [info])])
    theirs = np.empty(events.size, faery.EVENTS_DTYPE)
    for name, their_name in (("t", "t"), ("x", "x"), ("y", "y"), ("p", "on")):
        theirs[their_name] = events[name]
    with aedat.Encoder(path, [tree], compression) as encoder:
        for part in np.array_split(theirs, 3):
            encoder.write(0, part)


@pytest.fixture
def read_frames(tmp_path: Path) -> Callable[..., Recording]:
    """read_frames(*packets): the recording that a file of these FRME packets and nothing else gives."""

    def read_them(*packets: bytes | bytearray) -> Recording:
        head = MAGIC + header_bytes([DvStream(1, "FRME", "DAVIS346_1", (346, 260))])
        body = b"".join(PACKET.pack(1, len(packet)) + packet for packet in packets)
        (tmp_path / "a.aedat4").write_bytes(head + body)
        return read(tmp_path / "a.aedat4")

    return read_them


def test_events(tmp_path: Path, make_events) -> None:
    events = make_events(3000, START_US)
    write(tmp_path / "a.aedat4", events)
    recording = read(tmp_path / "a.aedat4")
    np.testing.assert_array_equal(recording.events, events)
    assert (recording.width, recording.height, recording.frames) == (346, 260, None)


def test_zstd_is_read(tmp_path: Path, make_events) -> None:
    events = make_events(3000, START_US)
    write(tmp_path / "a.aedat4", events, "ZSTD", ("zstd", 1))
    np.testing.assert_array_equal(read(tmp_path / "a.aedat4").events, events)


@pytest.mark.parametrize(("name", "library"), [("lz4", "lz4.frame"), ("zstd", "backports.zstd")])
def test_a_missing_library_is_named_with_its_extra(
    name: str, library: str, tmp_path: Path, make_events, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = importlib.import_module

    def without(wanted: str) -> object:
        if wanted == library:
            raise ModuleNotFoundError(wanted)
        return real(wanted)

    write(tmp_path / "a.aedat4", make_events(30), name.upper(), (name, 1))
    monkeypatch.setattr(importlib, "import_module", without)
    with pytest.raises(FormatError, match=rf"reading it takes {library}: pip install 'voltcam\[lab\]'"):
        read(tmp_path / "a.aedat4")


def test_a_frames_time_is_the_middle_of_its_exposure(read_frames) -> None:
    images = np.random.default_rng(3).integers(0, 256, (4, 260, 346), np.uint8)
    begins = [START_US + 40_000 * i for i in range(4)]
    packets = [frame_packet(image, (t, t + 501)) for t, image in zip(begins, images, strict=True)]
    recording = read_frames(*packets)
    np.testing.assert_array_equal(recording.frames, images)
    assert recording.exposure_us.tolist() == [[t, t + 501] for t in begins]
    assert recording.frame_t_us.tolist() == [t + 250 for t in begins]
    assert recording.events.size == 0


def test_without_exposures_the_frames_time_counts(read_frames) -> None:
    image = np.zeros((260, 346), np.uint8)
    recording = read_frames(frame_packet(image, (7000, 7000)), frame_packet(image, (8000, 8000)))
    assert recording.exposure_us is None
    assert recording.frame_t_us.tolist() == [7000, 8000]


def test_colours_become_luminance(read_frames) -> None:
    """DV keeps blue, green, red: its format 16 is three channels."""
    wide = bytearray(frame_packet(np.tile(np.array([0, 0, 255], np.uint8), (2, 4)), (0, 9)))
    wide[14 + 4 + 2 * 5 : 14 + 4 + 2 * 5 + 2] = (4).to_bytes(2, "little")  # the format's place in the table
    wide[44 + 4] = 16
    wide[44 + 8 : 44 + 10] = (4).to_bytes(2, "little")
    assert set(read_frames(wide).frames.ravel()) == {76}  # 0.299 * 255


def test_frames_of_two_sizes_are_refused(read_frames) -> None:
    packets = [frame_packet(np.zeros(shape, np.uint8), (0, 9)) for shape in ((260, 346), (2, 4))]
    with pytest.raises(FormatError, match="frame 1 is 4x2, the first is 346x260: record one size"):
        read_frames(*packets)


def test_few_bytes_that_say_they_are_many(tmp_path: Path) -> None:
    """160 MB of events in a packet of some kilobytes."""
    packet = zstd.compress(events_packet(np.zeros(10_000_000, EVENT)))
    header = bytearray(header_bytes([DvStream(0, "EVTS", "DAVIS346_1", (346, 260))]))
    header[32] = 3
    (tmp_path / "a.aedat4").write_bytes(MAGIC + header + PACKET.pack(0, len(packet)) + packet)
    with pytest.raises(FormatError, match="more than it can"):
        read(tmp_path / "a.aedat4")


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
