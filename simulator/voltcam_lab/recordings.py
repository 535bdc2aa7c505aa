"""A recording with its frames in memory, whatever the format."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from voltcam_client.formats import FormatError, Recording, read
from voltcam_video import SourceError, SourceRequest, open_source


def load(path: str | Path) -> Recording:
    """Read a recording; the images of an Event Camera Dataset folder become `frames`, luminance in 8 bit.

    Raises FormatError and RecordingError as voltcam_client.formats.read does, in one line.
    """
    recording = read(path)
    if not recording.image_paths:
        return recording
    try:
        with open_source(SourceRequest(uri=str(path), pace="fast")) as source:
            frames = list(source)
    except SourceError as error:
        raise FormatError(str(error)) from error
    shapes = {frame.image.shape for frame in frames}
    if len(shapes) > 1:
        raise FormatError(f"{path}: its images are of {len(shapes)} sizes: give images of one size")
    images = np.stack([np.rint(frame.image).astype(np.uint8) for frame in frames])
    t_us = np.array([frame.t_us for frame in frames], np.int64)
    return replace(recording, frames=images, frame_t_us=t_us, image_paths=())
