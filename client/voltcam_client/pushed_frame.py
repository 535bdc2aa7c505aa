"""A frame that a program sends to a camera, and the answer: the wire contract of `--source zmq+tcp://...`.

The sender's REQ or DEALER socket sends two parts, header and image. Each frame has one answer, of one part.
Header and answer are JSON maps, so that a sender needs no library but ZeroMQ: `printf` can write them.

header      value                                              without it
==========  =================================================  ==========================================
t_us        the sender's clock, whole us, 0 to 2^53 - 1        refused
encoding    see ENCODINGS and COMPRESSED                       refused
width       pixels                                             refused, unless compressed
height      pixels                                             refused, unless compressed
step        bytes a row, where rows are padded                 rows without padding
wait        false: do not wait for room, the newest wins       true: it waits for its turn, and is not dropped
begin       true: does not follow from the frame before; time  false: later than the one before, of its size
            and size may be any
==========  =================================================  ==========================================

answer      value
==========  =============================================================================================
t_us        that of the frame; null where its header could not be read
result      simulated; skipped: time went on without events; dropped: a newer one came; refused: not taken
reason      one line; empty where it was simulated
shift_us    what was added to the sender's clock to have the events', after a `begin` that went back
==========  =============================================================================================
"""

import json
from dataclasses import asdict, dataclass, fields
from typing import Any, Literal, NamedTuple

from voltcam_client.errors import PacketError

__all__ = [
    "COMPRESSED",
    "ENCODINGS",
    "HEADER_BYTES",
    "MOST_BYTES",
    "MOST_PIXELS",
    "Answer",
    "FrameHeader",
    "PixelLayout",
    "Result",
    "check_size",
    "decode_answer",
    "decode_header",
    "encode_answer",
    "encode_header",
]

MOST_PIXELS = 4096 * 4096
MOST_SIDE = 16384
MOST_BYTES = 8 * MOST_PIXELS  # of an image as it is sent: rgba16 without padding
HEADER_BYTES = 4096
MOST_US = 2**53  # a double holds any whole number below, and so does JSON everywhere


Result = Literal["simulated", "skipped", "dropped", "refused"]


class PixelLayout(NamedTuple):
    """dtype: of a channel, NumPy's name. channels: their order in a pixel."""

    dtype: str
    channels: str


ENCODINGS = {
    f"{name}{bits}": PixelLayout(dtype, channels)
    for bits, dtype in ((8, "u1"), (16, "<u2"))
    for name, channels in (("mono", "L"), ("rgb", "RGB"), ("bgr", "BGR"), ("rgba", "RGBA"), ("bgra", "BGRA"))
}
"""Raw images, rows from the top: mono8, rgb8, bgr8, rgba8, bgra8, and mono16 to bgra16, little-endian."""
COMPRESSED = ("jpeg", "png")


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameHeader:
    """As the table at the top has it. width, height: None where the image itself says so."""

    t_us: int
    encoding: str
    width: int | None = None
    height: int | None = None
    step: int | None = None
    wait: bool = True
    begin: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What became of a frame."""

    t_us: int | None
    result: Result
    reason: str = ""
    shift_us: int = 0


def encode_header(header: FrameHeader) -> bytes:
    """What is not said is left out."""
    return _packed({key: value for key, value in asdict(header).items() if value is not None})


def decode_header(header_bytes: bytes) -> FrameHeader:
    """PacketError for what is no header, or that of an image which nobody takes."""
    if len(header_bytes) > HEADER_BYTES:
        raise PacketError(f"a header of {len(header_bytes)} bytes: give at most {HEADER_BYTES}")
    content = _unpacked(header_bytes, "the header")
    unknown = sorted(content.keys() - {field.name for field in fields(FrameHeader)})
    if unknown:
        known = ", ".join(field.name for field in fields(FrameHeader))
        raise PacketError(f"the header has {unknown[0][:40]!r}, which is none of {known}")
    _check_types(content)
    encoding = content.get("encoding")
    if not isinstance(encoding, str) or encoding not in (*ENCODINGS, *COMPRESSED):
        raise PacketError(
            f"encoding is {str(encoding)[:40]!r}: give one of {', '.join((*ENCODINGS, *COMPRESSED))}"
        )
    if encoding in ENCODINGS and not ("width" in content and "height" in content):
        raise PacketError(f"{encoding} needs width and height in the header")
    header = FrameHeader(**content)
    if header.width is not None and header.height is not None:
        check_size(header.width, header.height)
    return header


def check_size(width: int, height: int) -> None:
    """Raises PacketError for an image larger than is taken."""
    if max(width, height) > MOST_SIDE or width * height > MOST_PIXELS:
        raise PacketError(
            f"{width} x {height} pixels are too many: send at most {MOST_PIXELS}, {MOST_SIDE} a side"
        )


def encode_answer(answer: Answer) -> bytes:
    return _packed(asdict(answer))


def decode_answer(answer_bytes: bytes) -> Answer:
    """PacketError for what is no answer."""
    try:
        return Answer(**_unpacked(answer_bytes, "the answer"))
    except TypeError as error:
        raise PacketError(f"the answer is none ({error}): is it a Voltcam daemon?") from None


def _check_types(content: dict[str, Any]) -> None:
    limits = {
        "t_us": (0, MOST_US - 1),
        "width": (1, MOST_SIDE),
        "height": (1, MOST_SIDE),
        "step": (1, MOST_BYTES),
    }
    if "t_us" not in content:
        raise PacketError("the header has no t_us: give the frame's time in whole microseconds")
    for key, value in content.items():
        if key in limits:
            low, high = limits[key]
            if type(value) is not int or not low <= value <= high:
                raise PacketError(f"{key} is {str(value)[:40]}: give a whole number from {low} to {high}")
        elif key in ("wait", "begin") and type(value) is not bool:
            raise PacketError(f"{key} is {str(value)[:40]}: give true or false")


def _packed(content: dict[str, Any]) -> bytes:
    return json.dumps(content, separators=(",", ":")).encode()


def _unpacked(packed: bytes, what: str) -> dict[str, Any]:
    try:
        content = json.loads(packed)
    except (ValueError, RecursionError):  # of JSON, of UTF-8, of numbers without end, nested too deep
        raise PacketError(f"{what} is not JSON: send a map such as " + EXAMPLE) from None
    if not isinstance(content, dict):
        raise PacketError(f"{what} is no JSON map: send one such as " + EXAMPLE)
    return content


EXAMPLE = '{"t_us": 0, "encoding": "mono8", "width": 346, "height": 260}'
