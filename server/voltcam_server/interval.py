"""What the simulation gives: the events between two frames, and what they were made with."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Camera, Law, Parameters
from voltcam_video import Image

from .beside import NOTHING, Beside, Frames
from .camera_settings import Upsample

How = Literal["advanced", "jumped", "given up", "replayed"]


@dataclass(frozen=True, slots=True, eq=False)
class Interval:
    """The time between two frames: its events, sorted by t, and the frame (height, width) at its end.

    start_us, end_us: it has all events stamped from start_us to end_us; that is before the frames where an
    effect stamps events earlier than they were. frame_us: the frame's time. arrived_s: when that frame came,
    ready_s: when its events were known, `time.monotonic()`. paced: as of an Arrival.
    how, coarser, parameters: what its events were made with, so that they can be made again. beside: what a
    DAVIS gives in it beside events. gamma: exponent from the image's grey levels to light.
    """

    events: NDArray[np.void]
    start_us: int
    end_us: int
    frame_us: int
    image: Image
    parameters: Parameters
    parameters_version: int
    how: How
    coarser: float
    arrived_s: float
    ready_s: float
    paced: bool
    beside: Beside = NOTHING
    gamma: float = 1.0

    @property
    def image_u8(self) -> NDArray[np.uint8]:
        """The frame as a viewer wants it."""
        if self.image.dtype == np.uint8:
            return self.image.astype(np.uint8, copy=False)
        return np.clip(np.rint(self.image), 0, 255).astype(np.uint8)


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """The sensor before the first interval of a recording. state: empty for a new one. follows: the first
    frame goes on from the one in `state`. source: as it may be shown."""

    state: dict[str, NDArray[Any]]
    follows: bool
    parameters: Parameters
    parameters_version: int
    source: str


@dataclass(frozen=True, slots=True, eq=False)
class SimulationSetup:
    """What all intervals of a recording are made with: camera, law, seed and frames between frames.

    frames: which ones the recording is to hold.
    """

    camera: Camera
    law: Law
    seed: int
    upsample: Upsample
    frames: Frames = "source"
