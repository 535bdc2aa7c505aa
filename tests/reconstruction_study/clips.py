"""The clips that all networks of a contender see, made once and kept in a file."""

import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch

from voltcam_lab.torch import EventClips, Photographs

from .contenders import sensor_of
from .network import BINS

WINDOW_US, WINDOWS = 40_000, 12  # about a frame of slider_depth
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Clips:
    """grids: (N, WINDOWS, BINS, H, W) float16; images: (N, WINDOWS, H, W) float16, light of 0..1."""

    grids: torch.Tensor
    images: torch.Tensor
    events: int


def made(name: str, photographs: Path, count: int, size: int, seed: int, kept: Path) -> Clips:
    """Clips of a contender's events. The scenes of a number are the same for all contenders."""
    if kept.exists():
        return Clips(**torch.load(kept, weights_only=True, mmap=True))
    clips = EventClips(
        Photographs(photographs, width=240, height=180),
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
