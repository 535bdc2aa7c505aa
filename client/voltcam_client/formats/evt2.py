"""`.evt2.raw`: a Prophesee EVT 2.0 file, which expelliarmus reads, too. Events only.

Lines with %, as in `raw`, then 32-bit words, little-endian:

    bits 28..31   0: OFF event, 1: ON event         8: time high
    bits 22..27   time, bits 0..5                   bits 0..27: time, bits 6..33
    bits 11..21   x
    bits 0..10    y

Source: docs.prophesee.ai/stable, data/encoding_formats/evt2.html.
"""

import numpy as np

from voltcam_client.encodings import EVENT, Buffer, Column, Events
from voltcam_client.formats.evt_header import HeaderWriter

DESCRIPTION = "Prophesee EVT 2.0, for those and expelliarmus"

_LOW_BITS, _HIGH_BITS = 6, 28
_TIME_HIGH = 8


class Evt2Writer(HeaderWriter):
    """Appends EVT 2.0 words."""

    name = ".evt2.raw"
    longest_side = 2048
    longest_span_us = 1 << _LOW_BITS + _HIGH_BITS

    def _header(self) -> bytes:
        size = f"height={self.height};width={self.width}\n% geometry {self.width}x{self.height}"
        return f"% evt 2.0\n% format EVT2;{size}\n".encode()

    def _last_lines(self) -> bytes:
        """The first word is a time high of 0, for no reader to take it for a line."""
        first = np.array(_TIME_HIGH << 28, "<u4").tobytes()
        return f"% t0 {self._t0_us}\n% end\n".encode() + first

    def _words(self, events: Events) -> bytes:
        last_us = self._last_t_us - self._t0_us if self.event_count else 0
        high = events["t"] >> _LOW_BITS
        words = np.empty((events.size, 2), "<u4")
        words[:, 0] = high | _TIME_HIGH << 28
        words[:, 1] = (events["t"] & 0x3F) << 22 | events["p"].astype(np.int64) << 28
        words[:, 1] |= events["x"].astype("<u4") << 11 | events["y"]
        needed = np.ones(words.shape, bool)
        needed[:, 0] = np.diff(high, prepend=last_us >> _LOW_BITS) != 0
        return words[needed].tobytes()


def decode_evt2(buffer: Buffer) -> Events:
    """The events of EVT 2.0 words; half a last word is left out. A time high that falls by more than half of
    its range has gone round."""
    words = np.frombuffer(buffer, "<u4", len(buffer) // 4)
    kind = words >> 28
    is_high = kind == _TIME_HIGH
    high = np.append(0, (words[is_high] & 0xFFFFFFF).astype(np.int64))
    high[1:] += np.cumsum(np.diff(high) < -(1 << _HIGH_BITS - 1)) << _HIGH_BITS
    is_event = kind <= 1
    latest: Column = np.cumsum(is_high)[is_event]
    found = words[is_event]
    events = np.empty(found.size, EVENT)
    events["t"] = high[latest] << _LOW_BITS | found >> 22 & 0x3F
    events["x"], events["y"], events["p"] = found >> 11 & 0x7FF, found & 0x7FF, found >> 28
    return events
