"""Packets of a DV stream: events, frames, IMU samples and triggers as size-prefixed flatbuffers.

======== ======================================================================== =====================
packet   fields of a table, in their order                                        units
======== ======================================================================== =====================
EVTS     vector of 16-byte records: i64 t, i16 x, i16 y, u8 polarity, 3 unused    us, pixels
FRME     i64 t, begin and end of the frame, begin and end of its exposure;        us
         i8 format; i16 width, height, x and y of its corner; pixels;
         i64 exposure; i8 source (1: sensor)
IMUS     vector of tables: i64 t; f32 temperature; acceleration x, y, z;          us, C, g, degree/s, uT
         rotation x, y, z; magnetic field x, y, z
TRIG     vector of tables: i64 t, i8 kind                                         us
======== ======================================================================== =====================

An EVTS packet is a constant header and its records, so that it is written straight from numpy. A frame's t
is the begin of its exposure.
"""

import struct
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from voltcam_client.dv.flatbuffer import VECTOR, Table, TableVector, vector_head
from voltcam_client.encodings import EVENT, Buffer, Events
from voltcam_client.errors import PacketError
from voltcam_client.samples import IMU, TRIGGER, ImuSamples, Triggers

RECORD = np.dtype([("t", "<i8"), ("x", "<i2"), ("y", "<i2"), ("p", "u1"), ("unused", "V3")])
LARGEST_COORDINATE = (1 << 15) - 1

_SENSOR = 1
_CHANNELS = {0: 1, 16: 3, 24: 4}  # of OpenCV's 8-bit formats

# Prefix, root, name; then the list of fields of a table, and the table.
_FRAME_HEAD = struct.Struct("<II4s2x15Hi3xb4hI6qI")
_FRAME_FIELDS = (30, 68, 20, 28, 36, 44, 52, 0, 8, 10, 12, 14, 16, 60, 7)

_IMU_TABLE = np.dtype(
    [("fields", "<i4"), ("temperature_c", "<f4"), ("accel_g", "<f4", 3), ("gyro_deg_s", "<f4", 3),
     ("magnet_ut", "<f4", 3), ("t", "<i8"), ("unused", "V4")]
)  # fmt: skip
_IMUS = TableVector(b"IMUS", (26, _IMU_TABLE.itemsize, 44, *range(4, 44, 4)), _IMU_TABLE, aligned=4)
_TRIGGER_TABLE = np.dtype([("fields", "<i4"), ("unused", "V3"), ("kind", "u1"), ("t", "<i8")])
_TRIGGERS = TableVector(b"TRIG", (8, _TRIGGER_TABLE.itemsize, 8, 7), _TRIGGER_TABLE, aligned=0)


class DvFrame(NamedTuple):
    """A frame of a DV stream: image (H, W) or (H, W, 3 or 4) uint8, BGR; times in us, exposure (begin, end).

    Without an exposure its two times are equal.
    """

    image: NDArray[np.uint8]
    t_us: int
    exposure_us: tuple[int, int]


def events_packet(events: Events, room: int = 0) -> bytearray:
    """An EVTS packet behind `room` bytes, which are the caller's. PacketError for pixels beyond 32767."""
    begin = room + VECTOR.size
    packet = bytearray(begin + events.size * RECORD.itemsize)
    packet[room:begin] = vector_head(b"EVTS", events.size, events.size * RECORD.itemsize)
    records = np.frombuffer(packet, RECORD, events.size, begin)
    for name in "txyp":
        records[name] = events[name]
    if events.size and min(records["x"].min(), records["y"].min()) < 0:
        raise PacketError(f"a DV stream holds x and y up to {LARGEST_COORDINATE} only")
    return packet


def read_events(packet: Buffer, *, cut: bool = False) -> Events:
    """The events of an EVTS packet. cut: of one that a crash has cut short, those that are whole.

    Raises PacketError for what is no such packet.
    """
    records = Table.root(packet, b"EVTS").vector(0, RECORD, cut=cut)
    events = np.empty(records.size, EVENT)
    for name in "txyp":
        events[name] = records[name]
    return events


def frame_packet(
    image: NDArray[np.uint8], exposure_us: tuple[int, int], frame_us: tuple[int, int] | None = None
) -> bytearray:
    """A FRME packet of a (H, W) uint8 image; times (begin, end), frame_us: with the readout around it."""
    height, width = image.shape
    packet = bytearray(_FRAME_HEAD.size + image.size)
    begin_us, end_us = exposure_us
    times = (begin_us, *(frame_us or exposure_us), begin_us, end_us, end_us - begin_us)
    _FRAME_HEAD.pack_into(
        packet, 0, len(packet) - 4, 40, b"FRME", *_FRAME_FIELDS, 30, _SENSOR, width, height, 0, 0, 52,
        *times, image.size,
    )  # fmt: skip
    packet[_FRAME_HEAD.size :] = image.tobytes()
    return packet


def read_frame(packet: Buffer) -> DvFrame:
    """The frame of a FRME packet. Raises PacketError for what is no such packet."""
    table = Table.root(packet, b"FRME")
    channels = _CHANNELS.get(table.number(5, "b"))
    width, height = table.number(6, "h"), table.number(7, "h")
    pixels = table.vector(10, np.dtype("u1"))
    if channels is None or min(width, height) < 0 or pixels.size != width * height * channels:
        raise PacketError(f"{pixels.size} bytes are no 8-bit image of {width} x {height} pixels")
    image = pixels.reshape((height, width) if channels == 1 else (height, width, channels))
    return DvFrame(image, table.number(0, "q"), (table.number(3, "q"), table.number(4, "q")))


def imu_packet(samples: ImuSamples) -> bytes:
    """An IMUS packet of IMU samples; a DAVIS has no magnetometer."""
    tables = np.zeros(samples.size, _IMU_TABLE)
    for name in samples.dtype.names or ():
        tables[name] = samples[name]
    return b"".join(_IMUS.pieces(tables.size, [tables]))


def read_imu(packet: Buffer) -> ImuSamples:
    """The IMU samples of an IMUS packet, without magnetic fields. Raises PacketError."""
    rows = [
        (
            each.number(0, "q"),
            each.number(1, "f"),
            *([each.number(i + k, "f") for k in range(3)] for i in (2, 5)),
        )
        for each in Table.root(packet, b"IMUS").tables(0)
    ]
    return np.array(rows, IMU)


def triggers_packet(triggers: Triggers) -> bytes:
    """A TRIG packet of TRIGGER rows."""
    tables = np.zeros(triggers.size, _TRIGGER_TABLE)
    for name in ("t", "kind"):
        tables[name] = triggers[name]
    return b"".join(_TRIGGERS.pieces(tables.size, [tables]))


def read_triggers(packet: Buffer) -> Triggers:
    """The triggers of a TRIG packet. Raises PacketError."""
    rows = [(each.number(0, "q"), each.number(1, "B")) for each in Table.root(packet, b"TRIG").tables(0)]
    return np.array(rows, TRIGGER)
