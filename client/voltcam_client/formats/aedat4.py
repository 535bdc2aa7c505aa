"""`.aedat4`: what iniVation's DV writes. Compressed packets take lz4 or backports.zstd.

A frame's time is the middle of its exposure. Of several cameras in one file, the first one's events and
frames are read. What a crash has cut off is left out.
"""

import contextlib
from collections.abc import Callable
from pathlib import Path

import numpy as np

from voltcam_client.dv.file import file_header, mapped, packets_of
from voltcam_client.dv.packets import DvFrame, read_events, read_frame
from voltcam_client.dv.streams import DvHeader, DvStream
from voltcam_client.encodings import EVENT, Buffer, Events
from voltcam_client.errors import PacketError
from voltcam_client.formats.bounds import fits
from voltcam_client.formats.library import grey, library, stacked
from voltcam_client.formats.recording import FormatError, Recording, exposures_known, smallest_size

DESCRIPTION = "iniVation AEDAT4, with frames and their exposures"
MOST_PACKET_BYTES = 1 << 28  # uncompressed: no camera's are so large


def read_aedat4(path: Path) -> Recording:
    """Read events and frames; FormatError says what is wrong with the file."""
    try:
        events, frames, size = _read(path, mapped(path))
    except PacketError as error:
        raise FormatError(
            f"{path} is cut short or no AEDAT4 file ({error}): copy or record it again"
        ) from error
    width, height = size or smallest_size(events)
    if not frames:
        return Recording(events, width, height)
    exposure_us = np.array([frame.exposure_us for frame in frames], np.int64)
    known = exposures_known(exposure_us)
    t_us = exposure_us.sum(1) // 2 if known else np.array([frame.t_us for frame in frames], np.int64)
    images = stacked([grey(frame.image, "BGR") for frame in frames], path)
    return Recording(events, width, height, images, t_us, exposure_us=exposure_us if known else None)


def _read(path: Path, data: Buffer) -> tuple[Events, list[DvFrame], tuple[int, int] | None]:
    """Events, frames, and the size of the events' sensor where the file says it."""
    header, begin = file_header(data)
    of_events, of_frames = _first(header, "EVTS"), _first(header, "FRME")
    unpack, total = _unpacker(header.compression, path), 0
    events, frames = [np.empty(0, EVENT)], []
    for packet in packets_of(data, begin, header.table):
        is_events = of_events is not None and packet.stream == of_events.id
        if packet.cut:
            if is_events and not header.compression:
                with contextlib.suppress(PacketError):  # cut in its header
                    events.append(read_events(packet.data, cut=True))
            break
        if not is_events and (of_frames is None or packet.stream != of_frames.id):
            continue
        content = unpack(packet.data)
        total += len(content)
        fits(path, total)
        if is_events:
            events.append(read_events(content))
        else:
            frames.append(read_frame(content))
    return np.concatenate(events), frames, of_events.size if of_events else None


def _first(header: DvHeader, kind: str) -> DvStream | None:
    """The first camera's stream of a kind."""
    streams = [stream for stream in header.streams if stream.kind == kind]
    return min(streams, key=lambda stream: stream.id, default=None)


def _unpacker(compression: int, path: Path) -> Callable[[Buffer], Buffer]:
    """What makes a packet of its compressed bytes. Raises FormatError for a library that is not there."""
    if compression == 0:
        return lambda data: data
    if compression in (1, 2):
        decompressor = library("lz4.frame", path).LZ4FrameDecompressor
    elif compression in (3, 4):
        decompressor = library("backports.zstd", path).ZstdDecompressor
    else:
        raise PacketError(f"no compression has the number {compression}")

    def unpack(data: Buffer) -> Buffer:
        """At most MOST_PACKET_BYTES of it: a few bytes may say that they are many."""
        try:
            content: bytes = decompressor().decompress(data, MOST_PACKET_BYTES)
        except Exception as error:  # each library has its own
            raise PacketError("a packet cannot be decompressed") from error
        return content

    return unpack
