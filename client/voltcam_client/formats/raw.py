"""`.raw`: a Prophesee EVT 3.0 file, as Metavision, openeb, faery and evlib read it. Events only.

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
low too (its issue 19), so that no EVT 3.0 file gives it right times, whoever wrote it: it reads EVT 2.0 and
DAT.
"""

from pathlib import Path

import numpy as np

from voltcam_client.encodings import Events, decode_evt3, encode_evt3
from voltcam_client.formats.evt2 import decode_evt2
from voltcam_client.formats.evt_header import HeaderWriter, read_header
from voltcam_client.formats.recording import FormatError, Recording, smallest_size

DESCRIPTION = "Prophesee EVT 3.0, for Metavision, openeb, faery, evlib"

# Time high and time low: of the last tick and the first, and of the one half way.
_TURN = np.array([0x8FFF, 0x6FFF, 0x8000, 0x6000], "<u2").tobytes()
_HALF_TURN = np.array([0x8800, 0x6000], "<u2").tobytes()
_HALF_TURN_BITS = 23  # a file begins at such a half turn, see start_us


class RawWriter(HeaderWriter):
    """Appends EVT 3.0 words."""

    name = ".raw"
    longest_side = 2048
    longest_silence_us = 366 * 24 * 3600 * 1_000_000  # takes 23 MB of turns

    def _header(self) -> bytes:
        size = f"height={self.height};width={self.width}\n% geometry {self.width}x{self.height}"
        return f"% evt 3.0\n% format EVT3;{size}\n".encode()

    def _last_lines(self) -> bytes:
        return f"% t0 {self._t0_us}\n% end\n".encode()

    def _words(self, events: Events) -> bytes:
        parts: list[bytes] = []
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
    """Read an EVT 3.0 or 2.0 file of ours or of a Prophesee camera; half a last word is left out."""
    data = path.read_bytes()
    header = read_header(path, data)
    version, kind = header.keywords.get("evt", ""), header.keywords.get("format", "")
    words = memoryview(data)[header.start :]
    if "3.0" in version or "EVT3" in kind:
        events = decode_evt3(words[: len(words) // 2 * 2], 0)
    elif version.startswith("2.0") or kind.partition(";")[0] == "EVT2":
        events = decode_evt2(words)
    else:
        raise FormatError(f"{path} is no EVT 3.0 or 2.0 file: convert it with Metavision's tools")
    events["t"] += header.t0_us
    return Recording(events, *(header.size or smallest_size(events)))
