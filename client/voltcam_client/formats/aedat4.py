"""`.aedat4`: what iniVation's DV writes. Read with faery; a frame's time is the middle of its exposure.

Source: docs.inivation.com, AEDAT 4.0.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import EVENT, Events
from voltcam_client.formats.library import grey, library, named, stacked
from voltcam_client.formats.recording import Recording, smallest_size

DESCRIPTION = "iniVation AEDAT4, with frames and their exposures"


def read_aedat4(path: Path) -> Recording:
    """Read events and frames. Of several cameras in one file, the first one's events and frames."""
    faery = library("faery", path)
    packets: list[Events] = []
    frames = []
    with named(path, "AEDAT4 file"), faery.aedat.Decoder(path) as decoder:
        tracks = {kind: _first(decoder.tracks(), kind) for kind in ("events", "frame")}
        for track, packet in _whole(decoder):
            if track.id == tracks["events"]:
                packets.append(_events(packet))
            elif track.id == tracks["frame"]:
                frames.append(packet)
        size = next((track.dimensions for track in decoder.tracks() if track.id == tracks["events"]), None)
        images = [grey(frame.pixels) for frame in frames]
    events = np.concatenate(packets) if packets else np.empty(0, EVENT)
    width, height = size or smallest_size(events)
    if not frames:
        return Recording(events, width, height)
    exposure_us = np.array([(frame.exposure_start_t, frame.exposure_end_t) for frame in frames], np.int64)
    known = bool((exposure_us[:, 1] > exposure_us[:, 0]).all())
    t_us = exposure_us.sum(1) // 2 if known else np.array([frame.t for frame in frames], np.int64)
    return Recording(
        events, width, height, stacked(images, path), t_us, exposure_us=exposure_us if known else None
    )


def _whole(decoder: Any) -> Iterator[tuple[Any, Any]]:
    """Tracks and packets, up to where a crash has cut the file short."""
    begun = False
    try:
        for item in decoder:
            yield item
            begun = True
    except RuntimeError:
        if not begun:
            raise


def _first(tracks: list[Any], kind: str) -> int | None:
    return min((track.id for track in tracks if track.data_type == kind), default=None)


def _events(packet: NDArray[np.void]) -> Events:
    events = np.empty(packet.size, EVENT)
    for name, theirs in (("t", "t"), ("x", "x"), ("y", "y"), ("p", "on")):
        events[name] = packet[theirs]
    return events
