"""Headers against those of dv-processing, byte for byte."""

import contextlib
import dataclasses

import pytest

from voltcam_client.dv import streams
from voltcam_client.dv.streams import NO_TABLE, DvStream, camera_name, header_bytes, read_header
from voltcam_client.errors import PacketError

DAVIS = DvStream(0, "EVTS", "DAVIS346_EMU00001", (346, 260))


@pytest.mark.parametrize(
    ("kind", "size"), [("EVTS", (346, 260)), ("FRME", (346, 260)), ("IMUS", None), ("TRIG", None)]
)
def test_a_streams_header_is_that_of_dv_processing(
    kind: str, size: tuple[int, int] | None, sent_by_dv, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(streams, "MODULE", "dv-processing")
    stream = DvStream(0, kind, "DAVIS346_X", size)
    theirs, _ = sent_by_dv(kind)
    assert header_bytes([stream]) == theirs
    assert read_header(theirs).streams == (stream,)


def test_what_is_written_is_read_back() -> None:
    all_streams = [DAVIS, dataclasses.replace(DAVIS, id=1, kind="FRME"), DvStream(2, "IMUS", "A&B <1>")]
    header = read_header(header_bytes(all_streams, table=12345, size=4080))
    assert (header.streams, header.compression, header.table) == (tuple(all_streams), 0, 12345)
    assert read_header(header_bytes([DAVIS])).table == NO_TABLE


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_a_header_has_the_room_that_it_is_given(count: int) -> None:
    several = [dataclasses.replace(DAVIS, id=i, source="X" * 40) for i in range(count)]
    assert len(header_bytes(several, size=4080)) == 4080


def test_entities_are_refused() -> None:
    header = header_bytes([DAVIS]).replace(b'<dv version="2.0">', b"<!DOCTYPE a      >")
    with pytest.raises(PacketError, match="no list of streams"):
        read_header(header)


def test_a_header_cut_or_changed_anywhere_gives_a_packet_error_or_what_it_holds() -> None:
    header = header_bytes([DAVIS])
    for at in range(len(header)):
        for damaged in (header[:at], header[:at] + b"\xff" + header[at + 1 :]):
            with contextlib.suppress(PacketError):
                read_header(damaged)


@pytest.mark.parametrize(
    ("size", "name"),
    [((346, 260), "DAVIS346_EMU00001"), ((240, 180), "DAVIS240C_EMU00001"), ((640, 480), "VOLTCAM_EMU00001")],
)
def test_a_camera_is_named_after_the_davis_of_its_size(size: tuple[int, int], name: str) -> None:
    assert camera_name(*size) == name
    assert camera_name(*size, "left") == name.replace("EMU00001", "left")
