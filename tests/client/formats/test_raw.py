"""`.raw` against other people's readers, and against the format's page read word by word."""

import tempfile
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from expelliarmus import Wizard
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_client.formats import FormatError, open_writer, read
from voltcam_client.packet import EVENT

Events = npt.NDArray[np.void]

EPOCH_US = 1_700_000_000_000_000
HOUR_US = 3600 * 10**6


def at(times: list[int]) -> Events:
    events = np.zeros(len(times), EVENT)
    events["t"] = times
    events["x"] = np.arange(len(times)) % 346
    events["p"] = np.arange(len(times)) % 2
    return events


def write(path: Path, events: Events, packet: int = 1000) -> None:
    with open_writer(path, width=346, height=260) as writer:
        for start in range(0, events.size, packet):
            writer.events(events[start : start + packet])


def as_openeb_counts(path: Path) -> list[int]:
    """The events' times by openeb's rule, where a turn is a time high that falls by 2048 or more.

    Checks on the way what its validator and faery want: a turn is 4095 then 0, and no leap is above 2048.
    """
    words = np.frombuffer(path.read_bytes().split(b"% end\n")[1], "<u2").tolist()
    turns = high = low = 0
    times = []
    for word in words:
        kind, value = word >> 12, word & 0xFFF
        if kind == 8:
            if high >= value + 2048:
                turns += 1
                assert (high, value) == (4095, 0)
            else:
                assert high <= value <= high + 2048
            high = value
        elif kind == 6:
            low = value
        elif kind == 2:
            times.append(turns << 24 | high << 12 | low)
    return times


def test_the_header(tmp_path: Path) -> None:
    write(tmp_path / "a.raw", at([EPOCH_US]))
    assert (tmp_path / "a.raw").read_bytes().split(b"\n")[:5] == [
        b"% evt 3.0",
        b"% format EVT3;height=260;width=346",
        b"% geometry 346x260",
        f"% t0 {EPOCH_US - EPOCH_US % 2**23}".encode(),
        b"% end",
    ]


def test_expelliarmus_reads_it(tmp_path: Path, make_events) -> None:
    """Times modulo 4096 us, because version 1.1.12 adds that whenever time low falls (its issue 19)."""
    events = make_events(20_000)
    write(tmp_path / "a.raw", events)
    theirs = Wizard(encoding="evt3").read(tmp_path / "a.raw")
    for name in "xyp":
        np.testing.assert_array_equal(theirs[name], events[name])
    np.testing.assert_array_equal(theirs["t"] % 4096, events["t"] % 4096)


def test_expelliarmus_reads_times_that_it_can(tmp_path: Path) -> None:
    """Where time low never falls, its times are right."""
    events = at([5, 4096 + 7, 10 * 4096 + 7, 2000 * 4096 + 4095])
    write(tmp_path / "a.raw", events)
    assert Wizard(encoding="evt3").read(tmp_path / "a.raw")["t"].tolist() == events["t"].tolist()


@pytest.mark.parametrize("start_us", [0, (1 << 24) - 5, EPOCH_US])
def test_faery_reads_it(start_us: int, tmp_path: Path, make_events) -> None:
    faery = pytest.importorskip("faery", reason="faery, another EVT3 reader, is not installed")
    events = make_events(5000, start_us)
    events["t"][2000:] += 100_000_000
    events["t"][4000:] += 10 * HOUR_US
    write(tmp_path / "a.raw", events)
    theirs = np.concatenate(list(faery.events_stream_from_file(tmp_path / "a.raw")))
    for name, their_name in (("t", "t"), ("x", "x"), ("y", "y"), ("p", "on")):
        np.testing.assert_array_equal(theirs[their_name], events[name])


@settings(deadline=None)  # disks are slow at times
@given(
    start_us=st.integers(0, 2 * EPOCH_US),
    gaps=st.lists(
        st.one_of(st.integers(0, 9000), st.integers(0, 2**25), st.integers(0, HOUR_US)), max_size=20
    ),
    packet=st.integers(1, 5),
)
def test_the_format_read_word_by_word(start_us: int, gaps: list[int], packet: int) -> None:
    events = at([start_us, *(start_us + np.cumsum(gaps, dtype=int)).tolist()])
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder) / "a.raw", events, packet)
        times = as_openeb_counts(Path(folder) / "a.raw")
    assert [t - times[0] for t in times] == (events["t"] - start_us).tolist()
    assert times[0] < 2**23


def test_a_long_silence_is_followed(tmp_path: Path) -> None:
    events = at([EPOCH_US, EPOCH_US + 10 * HOUR_US, EPOCH_US + 20 * HOUR_US])
    write(tmp_path / "a.raw", events, packet=1)
    np.testing.assert_array_equal(read(tmp_path / "a.raw").events, events)
    assert (tmp_path / "a.raw").stat().st_size < 100_000


def test_a_leap_of_years_is_refused(tmp_path: Path) -> None:
    with open_writer(tmp_path / "a.raw", width=346, height=260) as writer:
        writer.events(at([5]))
        for leap in (at([EPOCH_US]), at([6, EPOCH_US])):
            with pytest.raises(ValueError, match=r"a\.raw: event \d .*t leaps by .* begin another recording"):
                writer.events(leap)
        writer.events(at([7]))
    assert read(tmp_path / "a.raw").events["t"].tolist() == [5, 7]


def test_a_sensor_too_large_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"2048x2048 pixels, not 2049x10: choose \.npz"):
        open_writer(tmp_path / "a.raw", width=2049, height=10)
    assert not list(tmp_path.iterdir())


def test_a_camera_of_prophesee(tmp_path: Path) -> None:
    """A header as an EVK4 writes it, with words of the format's page: a vector of 12, one of 8, one event."""
    words = [0x8001, 0x6002, 0x0003, 0x3800 + 100, 0x4801, 0x5081, 0x2000 + 7]
    header = b"% date 2023-03-29 16:37:46\n% evt 3.0\n% format EVT3;height=720;width=1280\n% end\n"
    (tmp_path / "a.raw").write_bytes(header + np.array(words, "<u2").tobytes())
    recording = read(tmp_path / "a.raw")
    assert (recording.width, recording.height) == (1280, 720)
    on = [(4098, x, 3, True) for x in (100, 111, 112, 119)]
    assert recording.events.tolist() == [*on, (4098, 7, 3, False)]


def test_a_recording_killed_before_its_first_event(tmp_path: Path) -> None:
    writer = open_writer(tmp_path / "a.raw", width=346, height=260)
    recording = read(tmp_path / "a.raw")
    writer.close()
    assert (recording.events.size, recording.width, recording.height) == (0, 346, 260)


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (b"", "no EVT 3.0 or 2.0 file"),
        (b"\x00\x01garbage", "no EVT 3.0 or 2.0 file"),
        (b"% evt 2.1\n% format EVT21;height=1;width=1\n% end\n", "no EVT 3.0 or 2.0 file"),
        (b"% evt 3.0\n% geometry 346 by 260\n% end\n", "header that makes no sense"),
        (b"% evt 3.0\n% format EVT3;width=346\n% end\n", "header that makes no sense"),
        (b"% evt 3.0\n% t0 noon\n% end\n", "header that makes no sense"),
        (b"% evt 3.0\n% geometry 5x5\n% end\n\x00\x80\x00\x60\x00\x00\x09\x20", "outside a width of 5"),
    ],
)
def test_what_is_no_recording_is_named(content: bytes, fault: str, tmp_path: Path) -> None:
    (tmp_path / "a.raw").write_bytes(content)
    with pytest.raises(FormatError, match=fault) as error:
        read(tmp_path / "a.raw")
    assert str(error.value).startswith(str(tmp_path / "a.raw"))
    assert "\n" not in str(error.value)
