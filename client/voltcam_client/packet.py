"""The wire contract: what the daemon sends over ZeroMQ and WebSocket.

ZeroMQ     multipart [topic, header, buffer]; status: [topic, header]
WebSocket  header and buffer in one binary message; the msgpack header says itself where it ends

========== ==================================================== ====================================
topic      header: a msgpack map                                buffer
========== ==================================================== ====================================
events     ROS event_camera_msgs/EventPacket: header {stamp     the events, see `encodings`
           {sec, nanosec}, frame_id}, height, width, seq,
           time_base (ns), encoding, is_bigendian; and
           parameters_version, dropped
frames     ROS sensor_msgs/Image: header, height, width,        the image, `height` rows of `step`
           encoding ("mono8"), is_bigendian, step; and seq,     bytes
           time_base (ns), parameters_version; of an APS
           frame exposure_us, frame_us: [begin, end]; of a
           frame that is coded for screens, gamma
imu,       header, seq, count; see `samples`                    the samples, records
triggers
status     the same map as GET /api/v1/status                   none
========== ==================================================== ====================================

`stamp` is the host's clock (ns since 1970) when the message was made, so that latency is now - stamp.
`time_base` is on the events' own clock. The event buffers have a file of their own, `encodings`, and the
word streams of two of them another, `word_stream`: together they are too long for one page.
"""

from dataclasses import dataclass
from typing import Any

import msgpack
import numpy as np
import numpy.typing as npt

from voltcam_client.encodings import ENCODINGS, EVENT, Buffer, Encoding, Events
from voltcam_client.errors import PacketError
from voltcam_client.headers import pack_header, ros_header, stamp_ns_of, unpack_header

__all__ = [
    "EVENT",
    "TOPIC_EVENTS",
    "TOPIC_FRAMES",
    "TOPIC_STATUS",
    "FrameMessage",
    "Packet",
    "decode_frame",
    "decode_message",
    "decode_packet",
    "encode_frame",
    "encode_packet",
    "pack_message",
    "unpack_message",
]

TOPIC_EVENTS = b"events"
TOPIC_FRAMES = b"frames"
TOPIC_STATUS = b"status"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Packet:
    """Some successive events of one camera.

    - `events`: (N,) EVENT, sorted by t, from time_base_ns on.
    - `height`, `width`: of the camera, pixels.
    - `seq`: counts packets, so that a gap is a loss.
    - `time_base_ns`: the events' clock at the start of the packet; a whole number of us, 0 or more.
    - `stamp_ns`: the host's clock when the packet was made, ns since 1970.
    - `frame_id`: the camera's name.
    - `encoding`: libcaer, mono, evt3 or libcaer_cmp.
    - `parameters_version`: the version of the parameters that all of these events were made with.
    - `dropped`: source frames skipped since the daemon started, because a newer one was there.
    """

    events: Events
    height: int
    width: int
    seq: int
    time_base_ns: int
    stamp_ns: int
    frame_id: str = "voltcam"
    encoding: str = "libcaer"
    parameters_version: int = 0
    dropped: int = 0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FrameMessage:
    """One frame: one that the simulator was given, or one of the APS.

    - `image`: (H, W) uint8, grey levels.
    - `seq`: counts frames.
    - `t_us`: its time on the events' clock, us; of an APS frame the middle of its exposure.
    - `exposure_us`, `frame_us`: begin and end of an APS frame's exposure, and of the frame with its readout,
      on the events' clock; None for the simulator's.
    - `stamp_ns`, `frame_id`, `parameters_version`: as in `Packet`.
    - `gamma`: exponent from grey levels to light; 1 where they are light, 2.2 where a video is coded for
      screens.
    """

    image: npt.NDArray[np.uint8]
    seq: int
    t_us: int
    stamp_ns: int
    frame_id: str = "voltcam"
    parameters_version: int = 0
    exposure_us: tuple[int, int] | None = None
    frame_us: tuple[int, int] | None = None
    gamma: float = 1.0


def encode_packet(packet: Packet) -> tuple[bytes, bytes]:
    """Header and buffer. PacketError for an unknown encoding or events that do not fit it."""
    if packet.time_base_ns < 0 or packet.time_base_ns % 1000:
        raise PacketError(f"time_base_ns is {packet.time_base_ns}: give a whole number of us, 0 or more")
    header = {
        "header": ros_header(packet.stamp_ns, packet.frame_id),
        "height": packet.height,
        "width": packet.width,
        "seq": packet.seq,
        "time_base": packet.time_base_ns,
        "encoding": packet.encoding,
        "is_bigendian": False,
        "parameters_version": packet.parameters_version,
        "dropped": packet.dropped,
    }
    buffer = _encoding(packet.encoding).encode(packet.events, packet.time_base_ns // 1000)
    return pack_header(header), buffer


def decode_packet(header_bytes: Buffer, buffer: Buffer) -> Packet:
    """The packet of a header and a buffer, alone. PacketError if they are not one."""
    header = unpack_header(header_bytes)
    try:
        if header["is_bigendian"]:
            raise PacketError("the packet is big-endian, which no Voltcam daemon sends: is it one?")
        encoding = str(header["encoding"])
        return Packet(
            events=_encoding(encoding).decode(buffer, header["time_base"] // 1000),
            height=header["height"],
            width=header["width"],
            seq=header["seq"],
            time_base_ns=header["time_base"],
            stamp_ns=stamp_ns_of(header),
            frame_id=header["header"]["frame_id"],
            encoding=encoding,
            parameters_version=header["parameters_version"],
            dropped=header["dropped"],
        )
    except (KeyError, TypeError) as error:
        raise PacketError(f"the packet's header lacks or misuses {error}; is it a Voltcam daemon?") from error


def encode_frame(frame: FrameMessage) -> tuple[bytes, bytes]:
    """Header and buffer of a frame."""
    height, width = frame.image.shape
    header = {
        "header": ros_header(frame.stamp_ns, frame.frame_id),
        "height": height,
        "width": width,
        "encoding": "mono8",
        "is_bigendian": False,
        "step": width,
        "seq": frame.seq,
        "time_base": 1000 * frame.t_us,
        "parameters_version": frame.parameters_version,
    }
    for key in ("exposure_us", "frame_us"):
        if (span := getattr(frame, key)) is not None:
            header[key] = span
    if frame.gamma != 1:
        header["gamma"] = frame.gamma
    return pack_header(header), frame.image.tobytes()


def decode_frame(header_bytes: Buffer, buffer: Buffer) -> FrameMessage:
    """The frame of a header and a buffer; its image is read-only. PacketError if they are not one."""
    header = unpack_header(header_bytes)
    try:
        height, width, step = header["height"], header["width"], header["step"]
        if header["encoding"] != "mono8" or len(buffer) != height * step or step < width:
            raise PacketError(
                f"{len(buffer)} bytes are no {width}x{height} mono8 image with rows of {step} bytes"
            )
        return FrameMessage(
            image=np.frombuffer(buffer, np.uint8).reshape(height, step)[:, :width],
            seq=header["seq"],
            t_us=header["time_base"] // 1000,
            stamp_ns=stamp_ns_of(header),
            frame_id=header["header"]["frame_id"],
            parameters_version=header["parameters_version"],
            exposure_us=_span(header.get("exposure_us")),
            frame_us=_span(header.get("frame_us")),
            gamma=float(header.get("gamma", 1.0)),
        )
    except (KeyError, TypeError) as error:
        raise PacketError(f"the frame's header lacks or misuses {error}; is it a Voltcam daemon?") from error


def pack_message(header_bytes: bytes, buffer: bytes) -> bytes:
    """One binary message for a WebSocket."""
    return header_bytes + buffer


def unpack_message(message: Buffer) -> tuple[Buffer, Buffer]:
    """Header and buffer of a WebSocket message."""
    unpacker = msgpack.Unpacker()
    unpacker.feed(message)
    try:
        unpacker.skip()
    except (ValueError, msgpack.UnpackException) as error:
        raise PacketError(
            "the message does not start with a msgpack header; is it a Voltcam daemon?"
        ) from error
    view = memoryview(message)
    return view[: unpacker.tell()], view[unpacker.tell() :]


def decode_message(message: Buffer) -> Packet:
    """The packet in a WebSocket message; for frames, `decode_frame(*unpack_message(message))`."""
    return decode_packet(*unpack_message(message))


def _span(value: Any) -> tuple[int, int] | None:
    """TypeError for what is none."""
    if value is None:
        return None
    if not isinstance(value, list) or [type(each) for each in value] != [int, int]:
        raise TypeError("a span of time")
    return value[0], value[1]


def _encoding(name: str) -> Encoding:
    if name not in ENCODINGS:
        raise PacketError(f"unknown encoding {name!r}: this version of Voltcam knows {', '.join(ENCODINGS)}")
    return ENCODINGS[name]
