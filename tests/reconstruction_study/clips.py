"""The clips that all networks of a contender see, made once and kept in a file."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from voltcam_lab.torch import EventClips, Photographs
from voltcam_video.photos import PhotoFolder, light_of

from .contenders import sensor_of
from .network import BINS

WINDOW_US, WINDOWS = 40_000, 12  # about a frame of slider_depth
LONGEST_SIDE = 1200
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Clips:
    """grids: (N, WINDOWS, BINS, H, W) float16; images: (N, WINDOWS, H, W) float16, light of 0..1."""

    grids: torch.Tensor
    images: torch.Tensor
    events: int


def photographs(folder: Path) -> list[NDArray[np.float32]]:
    """The light of all photographs, made smaller once. Raises ValueError."""
    found = []
    for photograph in PhotoFolder(folder):
        light = light_of(photograph)
        step = -(-max(light.shape) // LONGEST_SIDE)
        rows, columns = (size // step * step for size in light.shape)
        cut = light[:rows, :columns].reshape(rows // step, step, columns // step, step)
        found.append(cut.mean(axis=(1, 3), dtype=np.float64).astype(np.float32))
    return found


def made(
    name: str, light: Sequence[NDArray[np.float32]], count: int, size: int, seed: int, kept: Path
) -> Clips:
    """Clips of a contender's events. The scenes of a number are the same for all contenders."""
    if kept.exists():
        return Clips(**torch.load(kept, weights_only=True, mmap=True))
    clips = EventClips(
        Photographs(light, width=240, height=180),
        sensor_of(name),
        width=size,
        height=size,
        windows=WINDOWS,
        window_us=WINDOW_US,
        bins=BINS,
        clips=count,
        seed=seed,
    )
    grids = torch.empty(count, WINDOWS, BINS, size, size, dtype=torch.float16)
    images = torch.empty(count, WINDOWS, size, size, dtype=torch.float16)
    events = 0
    for number in range(count):
        clip = clips.clip(0, number)
        events += sum(map(len, clip.events))
        grids[number] = torch.from_numpy(np.stack([clips.shape.represented(each) for each in clip.events]))
        images[number] = torch.from_numpy(clip.images / 255)
    content: dict[str, Any] = {"grids": grids, "images": images, "events": events}
    kept.parent.mkdir(parents=True, exist_ok=True)
    aside = kept.with_suffix(".partial")
    torch.save(content, aside)
    aside.replace(kept)
    log.info("%s: %d clips, %d events", name, count, events)
    return Clips(**content)
