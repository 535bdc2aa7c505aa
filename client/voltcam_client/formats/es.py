"""`.es`: Event Stream 2.0, as faery reads it. Events only, and times from the file's beginning only.

    "Event Stream", 2, 0, 0, 1 (DVS events), width u16, height u16
    an event: byte of time since the last one (7 bits) and polarity (bit 0); x u16, y u16, little-endian
    0xff between events: 127 us more; 0xfe: nothing

y counts from below; here it counts from above.

Sources: github.com/neuromorphic-paris/event_stream; the events' byte as faery 0.7.1 writes and reads it.
"""

import math
import struct
from pathlib import Path

import numpy as np

from voltcam_client.encodings import EVENT, Column, Events
from voltcam_client.formats.recording import FormatError, Recording
from voltcam_client.formats.writer import AppendWriter, start_us

DESCRIPTION = "Event Stream 2.0, for faery; times from the file's beginning"

_MAGIC = b"Event Stream"
_HEADER = struct.Struct("<12s3BBHH")
_DVS = 1
_OVERFLOW_US = 127
_EVENT_BYTES = 5


class EsWriter(AppendWriter):
    """Appends events of 5 bytes, after a byte for each 127 us without any."""

    holds_time_of_day = False
    longest_span_us = 1 << 34  # without an event that takes 135 MB

    def _header(self) -> bytes:
        return _HEADER.pack(_MAGIC, 2, 0, 0, _DVS, self.width, self.height)

    def _encode(self, events: Events) -> bytes:
        first_us = start_us(int(events["t"][0]))
        gaps_us = np.diff(events["t"], prepend=self._last_t_us if self.event_count else first_us)
        overflows, rest_us = np.divmod(gaps_us, _OVERFLOW_US)
        at = np.cumsum(overflows + _EVENT_BYTES) - _EVENT_BYTES
        data = np.full(at[-1] + _EVENT_BYTES, 0xFF, np.uint8)
        data[at] = rest_us << 1 | events["p"]
        data[at + 1], data[at + 2] = events["x"] & 0xFF, events["x"] >> 8
        y = self.height - 1 - events["y"]
        data[at + 3], data[at + 4] = y & 0xFF, y >> 8
        return data.tobytes()


def read_es(path: Path) -> Recording:
    """Read an Event Stream of DVS events, version 2; half a last event is left out."""
    content = path.read_bytes()
    if len(content) < _HEADER.size or not content.startswith(_MAGIC):
        raise FormatError(f"{path} does not begin as an Event Stream does: give it its right suffix")
    _, major, _, _, kind, width, height = _HEADER.unpack_from(content)
    if (major, kind) != (2, _DVS):
        raise FormatError(f"{path} holds no DVS events of Event Stream 2: convert it with faery")
    data = np.frombuffer(content, np.uint8, offset=_HEADER.size)
    at = _between_events(data)
    head = data[at]
    passed_us = np.where(head == 0xFE, 0, head >> 1)  # of 0xff: 127
    t_us = np.cumsum(passed_us, dtype=np.int64)
    is_event = (head < 0xFE) & (at + _EVENT_BYTES <= data.size)
    at = at[is_event]
    events = np.empty(at.size, EVENT)
    events["t"], events["p"] = t_us[is_event], head[is_event] & 1
    events["x"] = data[at + 1] | data[at + 2].astype(np.uint16) << 8
    events["y"] = height - 1 - (data[at + 3] | data[at + 4].astype(np.int64) << 8)
    return Recording(events, width, height)


def _between_events(data: Column) -> Column:
    """Where the bytes are that no event before them reaches over, (M,) int64.

    Each such byte says where the next one is, so they are a chain. It is followed in many blocks at once, for
    each of the five places where the chain may enter a block; then the right one of the five is known.
    """
    steps = np.where(data >= 0xFE, 1, _EVENT_BYTES).astype(np.uint8)
    block = max(_EVENT_BYTES, math.isqrt(data.size))
    begins = np.arange(0, data.size, block)
    ends = np.minimum(begins + block, data.size)
    at = begins[:, np.newaxis] + np.arange(_EVENT_BYTES)
    while (inside := at < ends[:, np.newaxis]).any():
        at[inside] += steps[at[inside]]
    leaves = at - ends[:, np.newaxis]
    enters = np.zeros(begins.size, np.int64)
    for number in range(1, begins.size):
        enters[number] = leaves[number - 1, enters[number - 1]]
    found = np.zeros(data.size, bool)
    at = begins + enters
    while (inside := at < ends).any():
        found[at[inside]] = True
        at[inside] += steps[at[inside]]
    return np.flatnonzero(found)
