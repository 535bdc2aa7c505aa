"""Images as ROS 2 sends them: the fields of a message in CDR of either byte order, nothing believed unseen.

Sources: those of `messages`.
"""

import struct
from typing import NamedTuple

from voltcam_client.errors import PacketError

ENCAPSULATION_BYTES = 4
# Big-endian or not, XTypes version 1 or 2, which lay these messages out alike.
BYTE_ORDERS = {b"\0\0": ">", b"\0\1": "<", b"\0\6": ">", b"\0\7": "<"}
MOST_PADDING = 3
SHOWN_CHARACTERS = 80


class ReceivedImage(NamedTuple):
    """sensor_msgs/Image, or CompressedImage, whose encoding is its `format` and which has no more."""

    t_us: int
    encoding: str
    data: memoryview
    width: int = 0
    height: int = 0
    step: int = 0
    is_bigendian: bool = False


def image(cdr: bytes) -> ReceivedImage:
    """Raises PacketError."""
    fields = _Fields(cdr, "sensor_msgs/Image")
    t_us = fields.stamp_us()
    height, width = fields.number("I"), fields.number("I")
    encoding, is_bigendian, step = fields.text(), bool(fields.number("B")), fields.number("I")
    return ReceivedImage(t_us, encoding, fields.last_octets(), width, height, step, is_bigendian)


def compressed_image(cdr: bytes) -> ReceivedImage:
    """Raises PacketError."""
    fields = _Fields(cdr, "sensor_msgs/CompressedImage")
    return ReceivedImage(fields.stamp_us(), fields.text(), fields.last_octets())


class _Fields:
    """One after the other. Raises PacketError where there is none."""

    def __init__(self, cdr: bytes, kind: str) -> None:
        self._kind, self._size = kind, len(cdr)
        self._data, self._at = memoryview(cdr)[ENCAPSULATION_BYTES:], 0
        order = BYTE_ORDERS.get(cdr[:2])
        if order is None or len(cdr) < ENCAPSULATION_BYTES:
            raise PacketError(
                f"{self._size} bytes are no {kind} in plain CDR: is its publisher one of ROS 2?"
            )
        self._order = order

    def stamp_us(self) -> int:
        """Of std_msgs/Header."""
        seconds, ns = self.number("i"), self.number("I")
        self.text()
        if seconds < 0 or ns >= 10**9:
            raise PacketError(f"the stamp is {seconds} s and {ns} ns: does its publisher set header.stamp?")
        return 1_000_000 * seconds + ns // 1000

    def number(self, code: str) -> int:
        size = struct.calcsize(code)
        self._at += -self._at % size
        return int(struct.unpack(self._order + code, self._next(size))[0])

    def text(self) -> str:
        """The beginning of a long one."""
        data = self._next(self.number("I"))
        return bytes(data[: min(len(data), SHOWN_CHARACTERS + 1)]).rstrip(b"\0").decode(errors="replace")

    def last_octets(self) -> memoryview:
        """To the end."""
        data = self._next(self.number("I"))
        if len(self._data) - self._at > MOST_PADDING:
            raise self._error()
        return data

    def _next(self, size: int) -> memoryview:
        data = self._data[self._at : self._at + size]
        if len(data) != size:
            raise self._error()
        self._at += size
        return data

    def _error(self) -> PacketError:
        return PacketError(f"{self._size} bytes are no whole {self._kind}: is its publisher one of ROS 2?")
