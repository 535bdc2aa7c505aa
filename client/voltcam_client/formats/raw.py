"""`.raw`: a Prophesee EVT 3.0 file, as Metavision, openeb, expelliarmus and faery read it. Events only.

    % evt 3.0
    % format EVT3;height=260;width=346
    % geometry 346x260
    % t0 1700000000000000
    % end
    16-bit words, little-endian: see voltcam_client.encodings

The words count microseconds from `t0`, modulo 2^24 (16.8 s). faery knows the keyword t0 and gives absolute
times, as `read` does; others give times from there. At every half turn of that clock, through silence too,
the file has its time, and before each full turn the last tick, so that readers follow however long nothing
happens.

Sources: docs.prophesee.ai/stable, data/file_formats/raw.html and data/encoding_formats/evt3.html. What
readers take for a turn: openeb's evt3_decoder.h a time high that falls by 2048, its evt3_validator.h and
faery's decoder one that goes from 4095 to 0 with no leap before it. expelliarmus 1.1.12 counts falls of time
low too (its issue 19): with it pixels and polarities are right, times are not, as for any EVT 3.0 file.
"""

from pathlib import Path

import numpy as np

from voltcam_client.encodings import Events, decode_evt3, encode_evt3
from voltcam_client.formats.recording import FormatError, Recording, smallest_size
from voltcam_client.formats.writer import AppendWriter

DESCRIPTION = "Prophesee EVT 3.0, for Metavision, openeb, expelliarmus, faery"

_HALF_TURN_BITS = 23
# Time high and time low: of the last tick and the first, and of the one half way.
_TURN = np.array([0x8FFF, 0x6FFF, 0x8000, 0x6000], "<u2").tobytes()
_HALF_TURN = np.array([0x8800, 0x6000], "<u2").tobytes()
_LARGEST_SIDE = 2048


class RawWriter(AppendWriter):
    """Appends EVT 3.0 words."""

    longest_silence_us = 366 * 24 * 3600 * 1_000_000  # takes 23 MB of turns

    def __init__(self, path: Path, width: int, height: int, *, overwrite: bool) -> None:
        if max(width, height) > _LARGEST_SIDE:
            raise FormatError(f"{path}: .raw has at most 2048x2048 pixels, not {width}x{height}: choose .npz")
        super().__init__(path, width, height, overwrite=overwrite)
        self._t0_us = 0

    def _header(self) -> bytes:
        """All but t0, which the first event brings."""
        size = f"height={self.height};width={self.width}\n% geometry {self.width}x{self.height}"
        return f"% evt 3.0\n% format EVT3;{size}\n".encode()

    def _encode(self, events: Events) -> bytes:
        parts = []
        if self.event_count == 0:
            self._t0_us = int(events["t"][0]) >> _HALF_TURN_BITS << _HALF_TURN_BITS
            parts.append(f"% t0 {self._t0_us}\n% end\n".encode())
        events = events.copy()
        events["t"] -= self._t0_us
        half_turns = events["t"] >> _HALF_TURN_BITS
        last = max(self._last_t_us - self._t0_us, 0) >> _HALF_TURN_BITS
        for piece in np.split(events, np.flatnonzero(np.diff(half_turns)) + 1):
            t_us = int(piece["t"][0])
            now = t_us >> _HALF_TURN_BITS
            parts += (_HALF_TURN if passed % 2 else _TURN for passed in range(last + 1, now + 1))
            parts.append(encode_evt3(piece, t_us))
            last = now
        return b"".join(parts)


def read_raw(path: Path) -> Recording:
    """Read an EVT 3.0 file of ours or of a Prophesee camera; half a last word is left out."""
    data = path.read_bytes()
    header, start = _split(data)
    if "3.0" not in header.get("evt", "") and "EVT3" not in header.get("format", ""):
        raise FormatError(f"{path} is no EVT 3.0 file: convert it with Metavision's tools")
    try:
        t0_us = int(header.get("t0", 0))
        size = _size(header)
    except (ValueError, KeyError) as error:
        raise FormatError(f"{path} has a header that makes no sense ({error}): correct it") from error
    words = data[start : len(data) - (len(data) - start) % 2]
    events = decode_evt3(words, 0)
    events["t"] += t0_us
    return Recording(events, *(size or smallest_size(events)))


def _split(data: bytes) -> tuple[dict[str, str], int]:
    """The header's keywords and values, and where the words begin: after '% end', or all lines with %.

    A line that a crash has cut short is left out.
    """
    header: dict[str, str] = {}
    start = 0
    while data.startswith(b"% ", start) and "end" not in header:
        end = data.find(b"\n", start) + 1
        if end == 0:
            return header, len(data)
        keyword, _, value = data[start + 2 : end].decode("latin-1").strip().partition(" ")
        header[keyword] = value.strip()
        start = end
    return header, start


def _size(header: dict[str, str]) -> tuple[int, int] | None:
    """Width and height, from '% geometry WxH' or '% format EVT3;height=H;width=W', where they are."""
    if "geometry" in header:
        width, height = header["geometry"].split("x")
        return int(width), int(height)
    fields = dict(field.split("=", 1) for field in header.get("format", "").split(";") if "=" in field)
    return (int(fields["width"]), int(fields["height"])) if fields else None
