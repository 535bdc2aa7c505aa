"""Recordings with frames: what all of the lab works on."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import Events
from voltcam_client.formats import FormatError, Recording, read
from voltcam_video import SourceError, SourceRequest, open_source


@dataclass(frozen=True, eq=False)
class Footage:
    """Events and frames of one camera.

    events: EVENT (n,), sorted by t. width, height: of the events' sensor [pixels]. frames: (N, H, W) uint8
    [DN], one or more, at frame_t_us (N,) int64. exposure_us: (N, 2) int64, begin and end of each frame's
    exposure; None where the file does not say.
    """

    events: Events
    width: int
    height: int
    frames: NDArray[np.uint8]
    frame_t_us: NDArray[np.int64]
    exposure_us: NDArray[np.int64] | None = None


def load(path: str | Path) -> Footage:
    """Read a recording; the images of an Event Camera Dataset folder become `frames`, luminance in 8 bit.

    Raises FormatError and RecordingError as voltcam_client.formats.read does, in one line; FormatError also
    where there are no frames.
    """
    recording = read(path)
    if not recording.image_paths:
        return with_frames(recording, str(path))
    try:
        with open_source(SourceRequest(uri=str(path), pace="fast")) as source:
            listed = list(source)
    except SourceError as error:
        raise FormatError(str(error)) from error
    shapes = {frame.image.shape for frame in listed}
    if len(shapes) > 1:
        raise FormatError(f"{path}: its images are of {len(shapes)} sizes: give images of one size")
    frames = np.stack([np.rint(frame.image).astype(np.uint8) for frame in listed])
    t_us = np.array([frame.t_us for frame in listed], np.int64)
    return Footage(recording.events, recording.width, recording.height, frames, t_us, recording.exposure_us)


def with_frames(recording: Recording, name: str = "the recording") -> Footage:
    """A recording that has its frames in memory. Raises FormatError, in one line, for one without frames."""
    frames, t_us = recording.frames, recording.frame_t_us
    if frames is None or t_us is None or len(frames) == 0:
        raise FormatError(
            f"{name}: no frames: record frames and events of the same camera together (DAVIS: switch the "
            "frames on)"
        )
    return Footage(recording.events, recording.width, recording.height, frames, t_us, recording.exposure_us)
