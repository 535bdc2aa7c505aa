"""The table at a file's end, against what dv-processing finds by it; and files of a stranger."""

from pathlib import Path

import numpy as np
import pytest

from voltcam_client.dv.file import MAGIC, PACKET, file_header, mapped, packets_of, table_of
from voltcam_client.dv.packets import events_packet, imu_packet
from voltcam_client.dv.streams import DvStream, header_bytes
from voltcam_client.encodings import EVENT
from voltcam_client.errors import PacketError
from voltcam_client.samples import IMU

KINDS = {0: "EVTS", 2: "IMUS"}


def _packet(stream: int, packet: bytes | bytearray) -> bytes:
    return PACKET.pack(stream, len(packet)) + packet


def _file(count: int) -> bytes:
    """`count` packets of two events, and one of a sample of the IMU after each."""
    head = MAGIC + header_bytes([DvStream(0, "EVTS", "A_1", (8, 8)), DvStream(2, "IMUS", "A_1")])
    packets = []
    for i in range(count):
        events = np.array([(1000 * i, 1, 2, True), (1000 * i + 9, 3, 4, False)], EVENT)
        packets.append(_packet(0, events_packet(events)))
        packets.append(_packet(2, imu_packet(np.array([(1000 * i, 20, (0, 0, 0), (0, 0, 0))], IMU))))
    return head + b"".join(packets)


def _with_table(data: bytes) -> bytes:
    _, begin = file_header(data)
    head = MAGIC + header_bytes([DvStream(0, "EVTS", "A_1", (8, 8)), DvStream(2, "IMUS", "A_1")], len(data))
    assert len(head) == begin
    return head + data[begin:] + b"".join(table_of(data, begin, KINDS))


@pytest.mark.parametrize("count", [0, 1, 2, 5000])  # the last takes several blocks of the table
def test_dv_processing_finds_each_packet_by_the_table(count: int, tmp_path: Path) -> None:
    dv = pytest.importorskip("dv_processing", reason="dv-processing, the oracle, is not installed")
    path = tmp_path / "a.aedat4"
    path.write_bytes(_with_table(_file(count)))
    recording = dv.io.MonoCameraRecording(str(path))
    if not count:
        assert recording.getNextEventBatch() is None
        return
    last_us = 1000 * (count - 1) + 9
    assert recording.getTimeRange() == (0, last_us)
    assert recording.getEventsTimeRange(0, last_us + 1).size() == 2 * count
    middle = recording.getEventsTimeRange(1000 * (count // 2), 1000 * (count // 2) + 1)
    assert middle.timestamps().tolist() == [1000 * (count // 2)]
    assert recording.getImuTimeRange(0, last_us + 1)[-1].timestamp == 1000 * (count - 1)


def test_packets_end_where_the_table_begins() -> None:
    data = _with_table(_file(3))
    header, begin = file_header(data)
    assert [packet.stream for packet in packets_of(data, begin, header.table)] == [0, 2] * 3


def test_a_file_cut_anywhere_gives_whole_packets_and_one_that_is_cut() -> None:
    data = _file(3)
    _, begin = file_header(data)
    whole = [packet.at + len(packet.data) for packet in packets_of(data, begin)]
    for end in range(begin, len(data) + 1):
        packets = list(packets_of(data[:end], begin))
        assert sum(not packet.cut for packet in packets) == sum(at <= end for at in whole)
        assert all(not packet.cut for packet in packets[:-1])


def test_room_that_was_never_written_is_no_packet() -> None:
    data = _file(2)
    _, begin = file_header(data)
    assert len(list(packets_of(data + bytes(4096), begin))) == 4
    assert len(list(packets_of(data + PACKET.pack(0, -5) + bytes(99), begin))) == 4


@pytest.mark.parametrize("data", [b"", MAGIC, MAGIC + b"\xff" * 99, b"#!AER-DAT2.0\r\n" + bytes(99)])
def test_another_file_is_refused(data: bytes) -> None:
    with pytest.raises(PacketError):
        file_header(data)


def test_an_empty_file_is_mapped_as_nothing(tmp_path: Path) -> None:
    (tmp_path / "a").touch()
    assert len(mapped(tmp_path / "a")) == 0
