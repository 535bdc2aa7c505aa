"""`.aedat4`: what iniVation's DV writes. Read with faery; a frame's time is the middle of its exposure.

Source: docs.inivation.com, AEDAT 4.0.
"""

import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import EVENT, Events
from voltcam_client.formats.library import grey, library, named, stacked
from voltcam_client.formats.recording import FormatError, Recording, smallest_size

RESULT, REFUSED = "recording.npz", 3
DESCRIPTION = "iniVation AEDAT4, with frames and their exposures"


def read_aedat4(path: Path) -> Recording:
    """Read events and frames. Of several cameras in one file, the first one's events and frames.

    In a process of its own: on some damaged files faery ends the process that it is in.
    """
    library("faery", path)
    with tempfile.TemporaryDirectory(prefix="voltcam-aedat4-") as folder:
        command = [sys.executable, "-m", "voltcam_client.formats.aedat4", str(path), folder]
        done = subprocess.run(command, capture_output=True, encoding="utf-8", errors="replace", check=False)
        if done.returncode == REFUSED:
            raise FormatError(done.stdout.strip())
        if done.returncode:
            raise FormatError(f"{path} is cut short or no AEDAT4 file: copy or record it again")
        with np.load(Path(folder, RESULT)) as arrays:
            events, size = arrays["events"], arrays["size"].tolist()
            others = {
                name: arrays[name] for name in ("frames", "frame_t_us", "exposure_us") if name in arrays
            }
    return Recording(events, *size, **others)


def _give(path: Path, folder: Path) -> int:
    """In the process: decode, and leave what was found. Returns the exit status."""
    try:
        recording = decode_aedat4(path)
    except FormatError as error:
        sys.stdout.write(str(error))
        return REFUSED
    size = np.array([recording.width, recording.height])
    arrays = {
        "frames": recording.frames,
        "frame_t_us": recording.frame_t_us,
        "exposure_us": recording.exposure_us,
    }
    known: dict[str, Any] = {name: array for name, array in arrays.items() if array is not None}
    np.savez(folder / RESULT, events=recording.events, size=size, **known)
    return 0


def decode_aedat4(path: Path) -> Recording:
    """What `read_aedat4` reads, in this process."""
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


if __name__ == "__main__":
    sys.exit(_give(Path(sys.argv[1]), Path(sys.argv[2])))
