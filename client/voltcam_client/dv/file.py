"""An AEDAT4 file: magic, header, packets, and at its end a table of where each packet is.

    magic     "#!AER-DAT4.0" and a line end, 14 bytes
    IOHE      the streams, and where the table is
    packet    i32 stream, i32 bytes, then the packet; again and again
    FTAB      a vector of tables: stream and bytes, place behind these 8 bytes, elements, first and last t

A file whose end a crash has cut off has no table, and is read packet by packet.
"""

import mmap
import os
import struct
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from voltcam_client.dv.flatbuffer import PREFIX, Table, TableVector
from voltcam_client.dv.packets import RECORD, read_frame, read_imu, read_triggers
from voltcam_client.dv.streams import NO_TABLE, DvHeader, read_header
from voltcam_client.encodings import Buffer
from voltcam_client.errors import PacketError

MAGIC = b"#!AER-DAT4.0\r\n"
PACKET = struct.Struct("<ii")
MOST_PACKETS = 1 << 25  # in a table: beyond, its offsets would not fit

_ENTRY = np.dtype(
    [("fields", "<i4"), ("stream", "<i4"), ("bytes", "<i4"), ("at", "<i8"), ("elements", "<i8"),
     ("first_t", "<i8"), ("last_t", "<i8"), ("unused", "V4")]
)  # fmt: skip
_TABLE = TableVector(b"FTAB", (14, _ENTRY.itemsize, 12, 4, 20, 28, 36), _ENTRY, aligned=4)
_ENTRIES = 1 << 12  # at a time


def mapped(path: Path) -> memoryview:
    """The bytes of a file, without taking memory for them. OSError as it comes."""
    with path.open("rb") as file:
        if not os.fstat(file.fileno()).st_size:
            return memoryview(b"")  # nothing that could be mapped
        return memoryview(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))


@dataclass(frozen=True, slots=True)
class DvPacket:
    """A packet in a file. at: its place; data: its bytes; cut: whether the file ends in it."""

    stream: int
    at: int
    data: memoryview
    cut: bool


def file_header(data: Buffer) -> tuple[DvHeader, int]:
    """The header of a file, and where its packets begin. Raises PacketError."""
    if bytes(data[: len(MAGIC)]) != MAGIC or len(data) < len(MAGIC) + PREFIX.size:
        raise PacketError("it does not begin as an AEDAT4 file does")
    (size,) = PREFIX.unpack_from(data, len(MAGIC))
    end = len(MAGIC) + PREFIX.size + size
    return read_header(memoryview(data)[len(MAGIC) : end]), end


def packets_of(data: Buffer, begin: int, table: int = NO_TABLE) -> Iterator[DvPacket]:
    """The packets of a file from `begin` up to its table, or to where a crash has cut it off."""
    view = memoryview(data)
    end = table if begin <= table <= len(view) else len(view)
    while begin + PACKET.size < end:
        stream, size = PACKET.unpack_from(view, begin)
        if size <= 0:  # room that the disk had given, and that was not written any more
            return
        at = begin + PACKET.size
        begin = at + size
        yield DvPacket(stream, at, view[at : min(begin, end)], cut=begin > end)


def table_of(data: Buffer, begin: int, kinds: Mapping[int, str]) -> Iterator[bytes]:
    """The table of the packets from `begin` on, piece by piece; kinds: of streams. PacketError: too many."""
    count = sum(1 for _ in packets_of(data, begin))
    if count > MOST_PACKETS:
        raise PacketError(f"{count} packets are more than a table holds")
    return _TABLE.pieces(count, _entries(packets_of(data, begin), kinds))


def _entries(packets: Iterator[DvPacket], kinds: Mapping[int, str]) -> Iterator[NDArray[np.void]]:
    """The rows of a table, so many at a time."""
    while some := list(islice(packets, _ENTRIES)):
        entries = np.zeros(len(some), _ENTRY)
        for entry, packet in zip(entries, some, strict=True):
            entry["stream"], entry["bytes"], entry["at"] = packet.stream, len(packet.data), packet.at
            entry["elements"], entry["first_t"], entry["last_t"] = _span(packet.data, kinds[packet.stream])
        yield entries


def _span(packet: Buffer, kind: str) -> tuple[int, int, int]:
    """How many elements, and the first and last time."""
    if kind == "FRME":
        t_us = read_frame(packet).t_us
        return 1, t_us, t_us
    times = _TIMES[kind](packet)
    return times.size, int(times[0]), int(times[-1])


_TIMES: dict[str, Callable[[Buffer], NDArray[np.void]]] = {
    "EVTS": lambda packet: Table.root(packet, b"EVTS").vector(0, RECORD)["t"],
    "IMUS": lambda packet: read_imu(packet)["t"],
    "TRIG": lambda packet: read_triggers(packet)["t"],
}
