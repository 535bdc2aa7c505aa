"""What a DV network stream and an AEDAT4 file begin with: the IOHE flatbuffer, and in it the streams as XML.

IOHE: i32 compression, i64 place of the table at a file's end (-1: none), string of XML.
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal
from xml.etree import ElementTree
from xml.sax.saxutils import escape

import numpy as np

from voltcam_client.dv.flatbuffer import PREFIX, Table
from voltcam_client.encodings import Buffer
from voltcam_client.errors import PacketError

Kind = Literal["EVTS", "FRME", "IMUS", "TRIG"]
OUTPUTS: dict[Kind, str] = {"EVTS": "events", "FRME": "frames", "IMUS": "imu", "TRIG": "triggers"}
"""The name of a stream of each kind, by which dv-processing's readers find it."""

NO_TABLE = -1
MOST_HEADER_BYTES = 1 << 20  # more is no header
MODULE = "voltcam"
_MODELS = {(346, 260): "DAVIS346", (240, 180): "DAVIS240C"}

_HEAD = struct.Struct("<II4s6x5Hi")
_TABLE = struct.Struct("<iIq")
_STRING = _HEAD.size + _TABLE.size


@dataclass(frozen=True, slots=True)
class DvStream:
    """One stream. kind: EVTS and so on; source: MODEL_SERIAL of its camera; size: width, height in pixels."""

    id: int
    kind: str
    source: str = ""
    size: tuple[int, int] | None = None


@dataclass(frozen=True, slots=True)
class DvHeader:
    """What an IOHE says. table: where a file's table is, or NO_TABLE."""

    streams: tuple[DvStream, ...]
    compression: int
    table: int


def header_bytes(streams: Sequence[DvStream], table: int = NO_TABLE, size: int = 0) -> bytes:
    """An uncompressed stream's or file's size-prefixed header. size: fill it up to so many bytes."""
    xml = _xml(streams).encode()
    xml += b" " * max(0, size - _STRING - PREFIX.size - len(xml) - 1)
    text = PREFIX.pack(len(xml)) + xml + bytes(4 - len(xml) % 4)
    gap = 0 if size else -(_STRING + len(text)) % 8
    total = _STRING + gap + len(text)
    head = _HEAD.pack(total - 4, 24, b"IOHE", 10, 20 + gap, 4, 12, 8, 10)
    return head + _TABLE.pack(0, 12 + gap, table) + bytes(gap) + text


def read_header(data: Buffer) -> DvHeader:
    """The size-prefixed header at the beginning of data. Raises PacketError for what is none."""
    table = Table.root(data, b"IOHE")
    text = table.vector(2, np.dtype("u1")).tobytes()
    return DvHeader(tuple(_streams(text)), table.number(0, "i"), table.number(1, "q"))


def _xml(streams: Sequence[DvStream]) -> str:
    """As dv-processing lays it out."""
    lines = ['<dv version="2.0">', '    <node name="outInfo" path="/outInfo/">']
    for stream in streams:
        path = f"/outInfo/{stream.id}/"
        output = OUTPUTS.get(stream.kind, stream.kind)  # type: ignore[call-overload]
        about = {
            "compression": "NONE",
            "originalModuleName": MODULE,
            "originalOutputName": output,
            "typeIdentifier": stream.kind,
        }
        lines.append(f'        <node name="{stream.id}" path="{path}">')
        lines += [_attribute(12, key, "string", value) for key, value in about.items()]
        lines.append(f'            <node name="info" path="{path}info/">')
        if stream.size is not None:
            lines += [
                _attribute(16, key, "int", str(value))
                for key, value in zip(("sizeX", "sizeY"), stream.size, strict=True)
            ]
        lines += [_attribute(16, "source", "string", stream.source), "            </node>", "        </node>"]
    return "\n".join([*lines, "    </node>", "</dv>", ""])


def _attribute(indent: int, key: str, kind: str, value: str) -> str:
    return f'{" " * indent}<attr key="{key}" type="{kind}">{escape(value)}</attr>'


def _streams(text: bytes) -> list[DvStream]:
    if b"<!" in text or len(text) > MOST_HEADER_BYTES:  # a document type may name entities without end
        raise PacketError("the header is no list of streams: is it of iniVation's DV?")
    try:
        outputs = [
            node
            for out_info in ElementTree.fromstring(text).iter("node")
            if out_info.get("name") == "outInfo"
            for node in out_info.findall("node")
        ]
        return [_stream(node) for node in outputs]
    except (ElementTree.ParseError, ValueError) as error:
        raise PacketError("the header is no list of streams: is it of iniVation's DV?") from error


def _stream(node: ElementTree.Element) -> DvStream:
    said = {each.get("key"): each.text or "" for each in node.iter("attr")}
    width, height = int(said.get("sizeX", 0)), int(said.get("sizeY", 0))
    return DvStream(
        int(node.get("name", "")),
        said.get("typeIdentifier", ""),
        said.get("source", ""),
        (width, height) if width > 0 and height > 0 else None,
    )


def camera_name(width: int, height: int, serial: str = "EMU00001") -> str:
    """MODEL_SERIAL, as iniVation names cameras: the model is the DAVIS of this size, where there is one."""
    return f"{_MODELS.get((width, height), 'VOLTCAM')}_{serial}"
