"""`.dat`: Prophesee's DAT file, version 2. Events only.

    % Data file containing CD events.
    % Version 2
    % Width 346
    % Height 260
    % T0 1700000000000000
    12, 8: the kind of events and their bytes
    u32 t, u32 of x (bits 0..13), y (14..27) and polarity (28) for each, little-endian

Source: docs.prophesee.ai/stable, data/file_formats/dat.html.
"""

from pathlib import Path

import numpy as np

from voltcam_client.encodings import EVENT, Events
from voltcam_client.formats.evt_header import HeaderWriter, read_header
from voltcam_client.formats.recording import FormatError, Recording, smallest_size

DESCRIPTION = "Prophesee DAT, for Metavision, faery, expelliarmus"

_RECORD = np.dtype([("t", "<u4"), ("address", "<u4")])
_KIND = b"\x0c\x08"  # events of contrast detection, of 8 bytes
_TURN_US = 1 << 32


class DatWriter(HeaderWriter):
    """Appends records of 8 bytes."""

    name = ".dat"
    longest_side = 1 << 14
    longest_span_us = _TURN_US

    def _header(self) -> bytes:
        size = f"% Width {self.width}\n% Height {self.height}\n"
        return f"% Data file containing CD events.\n% Version 2\n{size}".encode()

    def _last_lines(self) -> bytes:
        return f"% T0 {self._t0_us}\n".encode() + _KIND

    def _words(self, events: Events) -> bytes:
        records = np.empty(events.size, _RECORD)
        records["t"] = events["t"]
        records["address"] = events["x"] | events["y"].astype("<u4") << 14 | events["p"].astype("<u4") << 28
        return records.tobytes()


def read_dat(path: Path) -> Recording:
    """Read a DAT file of version 1 or 2; half a last record is left out. A time that falls by more than half
    of its range has gone round."""
    data = path.read_bytes()
    header = read_header(path, data)
    if not header.keywords:
        raise FormatError(f"{path} does not begin with lines of %, as a .dat does: give it its right suffix")
    kind = data[header.start : header.start + 2]
    if len(kind) == 2 and kind not in (_KIND, b"\x00\x08"):
        raise FormatError(f"{path} holds no events of 8 bytes: convert it with Metavision's tools")
    start = min(header.start + 2, len(data))
    records = np.frombuffer(data, _RECORD, (len(data) - start) // _RECORD.itemsize, start)
    t_us = records["t"].astype(np.int64)
    t_us[1:] += np.cumsum(np.diff(t_us) < -_TURN_US // 2) * _TURN_US
    address = records["address"]
    bits = 9 if header.keywords.get("version") == "1" else 14
    events = np.empty(records.size, EVENT)
    events["t"] = t_us + header.t0_us
    events["x"] = address & (1 << bits) - 1
    events["y"] = address >> bits & (0xFF if bits == 9 else 0x3FFF)
    events["p"] = address >> (17 if bits == 9 else 28) & 1
    return Recording(events, *(header.size or smallest_size(events)))
