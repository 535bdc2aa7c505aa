"""Flatbuffers: made of numpy's arrays, and read with every offset checked, since they may be a stranger's.

    prefix   u32, how many bytes follow; offsets count from behind it
    root     u32, offset of the first table
    name     four letters: which table that is
    table    i32, how far before the table its list of fields is; then the fields
    fields   u16 bytes of the list, u16 bytes of the table, then u16 for each field: where it is in it, or 0
    vector   u32 count, then the elements; a field holds the offset from itself to it

Everything is little-endian.
"""

import struct
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import Buffer
from voltcam_client.errors import PacketError

PREFIX = struct.Struct("<I")
ROOT = struct.Struct("<II4s")
VECTOR = struct.Struct("<II4s2x3HiII")  # up to the count of a first table that is a vector alone
_U16, _U32, _I32 = struct.Struct("<H"), struct.Struct("<I"), struct.Struct("<i")

_PIECE = 1 << 16


class Table:
    """A table at an offset of the data. Every access raises PacketError where the data do not hold it."""

    def __init__(self, data: Buffer, at: int) -> None:
        self._data, self._at = data, at
        self._fields = at - self._read(_I32, at)
        self._fields_bytes = self._read(_U16, self._fields)

    @classmethod
    def root(cls, data: Buffer, name: bytes) -> "Table":
        """The first table of size-prefixed data, which must have this name."""
        if len(data) < ROOT.size or bytes(data[8:12]) != name:
            raise PacketError(f"no {name.decode()} packet: is it of iniVation's DV?")
        return cls(data, PREFIX.size + ROOT.unpack_from(data)[1])

    def number(self, field: int, kind: str) -> Any:
        """The value of a field, of a `struct` kind; 0 where it is left out."""
        at = self._where(field)
        return self._read(struct.Struct("<" + kind), at) if at else 0

    def vector(self, field: int, dtype: np.dtype[Any], *, cut: bool = False) -> NDArray[Any]:
        """The elements of a vector; none where it is left out. cut: those that the data still hold whole."""
        begin, count = self._vector(field)
        if cut:
            count = min(count, (len(self._data) - begin) // dtype.itemsize)
        if begin + count * dtype.itemsize > len(self._data):
            raise PacketError("a vector is longer than its packet: it is cut short or damaged")
        return np.frombuffer(self._data, dtype, count, begin) if count else np.empty(0, dtype)

    def tables(self, field: int) -> Iterator["Table"]:
        """The tables that a vector names."""
        begin, _ = self._vector(field)
        for index, offset in enumerate(self.vector(field, np.dtype("<u4")).tolist()):
            yield Table(self._data, begin + 4 * index + offset)

    def _vector(self, field: int) -> tuple[int, int]:
        at = self._where(field)
        if not at:
            return 0, 0
        begin = at + self._read(_U32, at)
        return begin + 4, self._read(_U32, begin)

    def _where(self, field: int) -> int:
        entry = 4 + 2 * field
        if entry + 2 > self._fields_bytes:
            return 0
        offset = self._read(_U16, self._fields + entry)
        return self._at + offset if offset else 0

    def _read(self, kind: struct.Struct, at: int) -> Any:
        if not 0 <= at <= len(self._data) - kind.size:
            raise PacketError("an offset leads out of its packet: it is cut short or damaged")
        return kind.unpack_from(self._data, at)[0]


def vector_head(name: bytes, count: int, elements_bytes: int) -> bytes:
    """What stands before the elements of a first table that is a vector alone."""
    return VECTOR.pack(VECTOR.size - PREFIX.size + elements_bytes, 16, name, 6, 8, 4, 6, 4, count)


@dataclass(frozen=True, slots=True)
class TableVector:
    """A first table that is a vector of tables which share one list of fields.

    fields: that list. dtype: of a table, its first member "fields". aligned: where in 8 bytes each begins.
    """

    name: bytes
    fields: tuple[int, ...]
    dtype: np.dtype[Any]
    aligned: int

    def pieces(self, count: int, tables: Iterable[NDArray[Any]]) -> Iterator[bytes]:
        """The bytes, piece by piece, for `count` tables in arrays of dtype, whose "fields" are set here."""
        earliest = VECTOR.size + _U32.size * count + _U16.size * len(self.fields)
        first = earliest + (self.aligned - earliest) % 8
        yield vector_head(self.name, count, first - VECTOR.size + self.dtype.itemsize * count)
        for start in range(0, count, _PIECE):
            number = np.arange(start, min(start + _PIECE, count))
            at = first + self.dtype.itemsize * number
            yield (at - VECTOR.size - _U32.size * number).astype("<u4").tobytes()
        yield bytes(first - earliest) + struct.pack(f"<{len(self.fields)}H", *self.fields)
        start = _U16.size * len(self.fields)
        for each in tables:
            each["fields"] = start + self.dtype.itemsize * np.arange(each.size)
            start += each.nbytes
            yield each.tobytes()
