"""Real events, cut at a real camera's frames."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from voltcam_lab.recordings import load
from voltcam_lab.representations import voxel_grid

from .measures import equalised, mse, ssim
from .network import BINS, FireNet, normalised

BEFORE = 10  # frames for the network's memory to settle, which do not count


@dataclass(frozen=True)
class Real:
    """grids: (N, BINS, H, W), the events from one frame to the next. frames: (N, H, W) in 0..1, at each
    window's end. counted: from which on.
    """

    name: str
    grids: torch.Tensor
    frames: NDArray[np.float64]
    counted: int


@dataclass(frozen=True)
class Measured:
    """Means over frames. Equalised: by ranks, of image and frame alike."""

    mse: float
    ssim: float
    mse_equalised: float
    ssim_equalised: float


def read(path: Path, name: str, share: float) -> Real:
    """The frames in the last `share` of a recording, and BEFORE more. Raises FormatError, OSError."""
    footage = load(path)
    t_us, events = footage.frame_t_us, footage.events
    begin_us = t_us[-1] - share * (t_us[-1] - t_us[0])
    first = max(1, int(np.searchsorted(t_us, begin_us)))
    from_frame = max(1, first - BEFORE)
    edges = np.searchsorted(events["t"], t_us)
    grids = [
        voxel_grid(
            events[edges[n - 1] : edges[n]],
            footage.width,
            footage.height,
            int(t_us[n - 1]),
            int(t_us[n]),
            BINS,
        )
        for n in range(from_frame, len(t_us))
    ]
    frames = footage.frames[from_frame:] / 255.0
    counted = max(first - from_frame, min(BEFORE, len(grids) - 1))
    return Real(name, torch.from_numpy(np.stack(grids)), frames, counted)


@torch.inference_mode()
def reconstructed(network: FireNet, real: Real) -> NDArray[np.float64]:
    """An image for each frame, (N, H, W)."""
    state, images = None, []
    for grid in normalised(real.grids):
        image, state = network(grid[None], state)
        images.append(image[0, 0].numpy().astype(np.float64))
    return np.stack(images)


def measured(images: NDArray[np.float64], real: Real) -> Measured:
    pairs = [
        (np.clip(image, 0, 1), frame, equalised(image), equalised(frame))
        for image, frame in zip(images[real.counted :], real.frames[real.counted :], strict=True)
    ]
    values = [
        (mse(image, frame), ssim(image, frame), mse(even, even_frame), ssim(even, even_frame))
        for image, frame, even, even_frame in pairs
    ]
    return Measured(*np.mean(values, axis=0).tolist())


def recordings(folder: Path) -> list[Real]:
    """The rest of slider_depth, which the calibration did not see, and davis346_street if it is there."""
    found = [read(folder / "slider_depth", "slider_depth", 0.4)]
    street = folder / "davis346_street" / "davis346.aedat4"
    if street.exists():
        found.append(read(street, "davis346_street", 1.0))
    return found
