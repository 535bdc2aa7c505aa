"""How long a video file says it is, so that one cut short is told from one that is whole.

The number of frames a file announces cannot tell: edit lists, audio that runs on and a first stamp above zero
all make it larger than what there is to read.
"""

from pathlib import Path
from typing import BinaryIO


def missing_bytes(path: Path) -> int:
    """Bytes by which an MP4/MOV, Matroska/WebM or AVI file is shorter than its own structure says; 0 for a
    whole file and for formats that do not say.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        start = file.read(12)
        if start[4:8] == b"ftyp":
            declared = _iso_bytes(file, size)
        elif start[:4] == b"\x1a\x45\xdf\xa3":
            declared = _matroska_bytes(file)
        elif start[:4] == b"RIFF":
            declared = 8 + int.from_bytes(start[4:8], "little")
        else:
            declared = 0
    return max(0, declared - size)


def _iso_bytes(file: BinaryIO, size: int) -> int:
    """End of the last box (ISO/IEC 14496-12, 4.2): 32 bit size and type; size 1: 64 bits, 0: to the end."""
    end = 0
    while end + 8 <= size:
        file.seek(end)
        box = int.from_bytes(file.read(4), "big")
        if box == 1:
            file.seek(end + 8)
            box = int.from_bytes(file.read(8), "big")
        if box < 8:
            break
        end += box
    return end


def _matroska_bytes(file: BinaryIO) -> int:
    """End of the Segment after the EBML header (RFC 8794, RFC 9559); 0 if unknown, as in live ones."""
    file.seek(4)
    header = _ebml_size(file)
    if header is None:
        return 0
    file.seek(header, 1)
    if file.read(4) != b"\x18\x53\x80\x67":
        return 0
    segment = _ebml_size(file)
    return 0 if segment is None else file.tell() + segment


def _ebml_size(file: BinaryIO) -> int | None:
    """A variable-size integer: as many leading zero bits as bytes that follow; None: all ones, unknown."""
    first = file.read(1)
    if not first or not first[0]:
        return None
    extra = 8 - first[0].bit_length()
    value = int.from_bytes(bytes([first[0] & (0x7F >> extra)]) + file.read(extra), "big")
    return None if value == (1 << 7 * (extra + 1)) - 1 else value
