"""`.aedat`: AEDAT 2.0, what jAER records and v2e writes. Read only, and events only.

    #!AER-DAT2.0, and more lines with #
    u32 address, u32 time in us, both big-endian, for each event

The address of a DAVIS: bit 31 is set for frames and IMU, bit 10 for triggers; else polarity is in bit 11 (1
is ON), x in bits 12..21, y in 22..30. Of a DVS128: bit 15 is set for triggers; else polarity is in bit 0 (0
is ON), x in bits 1..7, y in 8..14. jAER counts x from the right and y from below; here x is from the left, y
from above. A file that names no chip is taken for a DAVIS346's, as v2e writes it.

Sources: docs.inivation.com, AEDAT 2.0; tonic 1.7 (read_davis_346) and v2e for the way the axes run; jAER's
DVS128 for its polarity.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from voltcam_client.encodings import EVENT, Column
from voltcam_client.formats.recording import FormatError, Recording

DESCRIPTION = "AEDAT 2.0 of jAER and v2e, without frames"

_MAGIC = b"#!AER-DAT2.0"
_RECORD = np.dtype([("address", ">u4"), ("t", ">u4")])
_TURN_US = 1 << 32


@dataclass(frozen=True)
class _Chip:
    """Its size, and where its address has what; `other`: bits that say that it is no event."""

    width: int
    height: int
    x_bit: int = 12
    y_bit: int = 22
    on_bit: int = 11
    on: int = 1
    other: int = 1 << 31 | 1 << 10


_CHIPS = {
    "davis128": _Chip(128, 128),
    "davis208": _Chip(208, 192),
    "davis240": _Chip(240, 180),
    "sbret10": _Chip(240, 180),  # the DAVIS240's own name in older files
    "davis346": _Chip(346, 260),
    "davis640": _Chip(640, 480),
    "dvs128": _Chip(128, 128, x_bit=1, y_bit=8, on_bit=0, on=0, other=1 << 15 | 1 << 31),
    "tmpdiff128": _Chip(128, 128, x_bit=1, y_bit=8, on_bit=0, on=0, other=1 << 15 | 1 << 31),
}


def read_aedat2(path: Path) -> Recording:
    """Read the events of an AEDAT 2.0 file, sorted by time; half a last one is left out.

    Frames, IMU and triggers are left out. Raises FormatError for another version of AEDAT.
    """
    data = path.read_bytes()
    if not data.startswith(_MAGIC):
        raise FormatError(
            f"{path} is no AEDAT 2.0 file: give AEDAT 4 the suffix .aedat4, convert 3.1 with jAER"
        )
    chip, start = _header(data)
    records = np.frombuffer(data, _RECORD, (len(data) - start) // _RECORD.itemsize, start)
    t_us = _times(records["t"])
    address = records["address"].astype(np.uint32)
    is_event = address & chip.other == 0
    address, t_us = address[is_event], t_us[is_event]
    x = address >> chip.x_bit & (0x3FF if chip.x_bit == 12 else 0x7F)
    y = address >> chip.y_bit & (0x1FF if chip.y_bit == 22 else 0x7F)
    if (x >= chip.width).any() or (y >= chip.height).any():
        raise FormatError(
            f"{path} has events outside of {chip.width}x{chip.height} pixels: which chip is it of?"
        )
    events = np.empty(address.size, EVENT)
    events["t"], events["x"], events["y"] = t_us, chip.width - 1 - x, chip.height - 1 - y
    events["p"] = (address >> chip.on_bit & 1) == chip.on
    return Recording(events[np.argsort(events["t"], kind="stable")], chip.width, chip.height)


def _header(data: bytes) -> tuple[_Chip, int]:
    """The chip that the lines name, and where the events begin."""
    start = 0
    while data.startswith(b"#", start):
        start = data.find(b"\n", start) + 1 or len(data)
    named = re.search(rb"# AEChip:([^\r\n]*)", data[:start])
    name = named[1].decode("latin-1").lower() if named else ""
    return next((chip for key, chip in _CHIPS.items() if key in name), _CHIPS["davis346"]), start


def _times(t_us: Column) -> Column:
    """Times of 32 bits as whole ones: a fall by more than half of the range has gone round."""
    whole = t_us.astype(np.int64)
    whole[1:] += np.cumsum(np.diff(whole) < -_TURN_US // 2) * _TURN_US
    return whole
