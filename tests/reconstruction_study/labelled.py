"""Segmentation, as the paper's Table 1: frames with label images for training, real events for the test.

FOLDER/images.txt                 lines 'seconds filename', the Event Camera Dataset's layout
FOLDER/labels/NAME.png            for each image of that name: a class per pixel, 8 bit; 255 is not counted
FOLDER/events.txt                 of the test folder: the real events, and their sensor has the labels' size
"""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

from voltcam_lab.models.model import Model
from voltcam_lab.recordings import Footage, load
from voltcam_lab.representations import voxel_grid
from voltcam_video import SourceRequest, open_source

from .clips import WINDOWS, Clips
from .network import BINS, FireNet, normalised

UNCOUNTED = 255


@dataclass(frozen=True)
class Labelled:
    """frames: (N, H, W), light in 0..255 DN; t_us: (N,); labels: (N, H, W) uint8, UNCOUNTED where unknown.
    footage: with the events of a real camera, None where they are to be simulated.
    """

    frames: NDArray[np.float32]
    t_us: NDArray[np.int64]
    labels: NDArray[np.uint8]
    footage: Footage | None = None

    @property
    def classes(self) -> int:
        counted = self.labels[self.labels != UNCOUNTED]
        return int(counted.max()) + 1 if counted.size else 1


def read(folder: Path) -> Labelled:
    """Raises ValueError, SourceError and FormatError: a line that names the image and the remedy."""
    with open_source(SourceRequest(uri=str(folder), pace="fast")) as source:
        listed = list(source)
    names = [line.split()[1] for line in (folder / "images.txt").read_text().splitlines() if line.strip()]
    labels = [_label(folder, name, frame.image.shape) for name, frame in zip(names, listed, strict=True)]
    return Labelled(
        np.stack([255 * (frame.image.astype(np.float32) / 255) ** frame.gamma for frame in listed]),
        np.array([frame.t_us for frame in listed]),
        np.stack(labels),
        load(folder) if (folder / "events.txt").exists() else None,
    )


def _label(folder: Path, name: str, shape: tuple[int, ...]) -> NDArray[np.uint8]:
    path = folder / "labels" / f"{Path(name).stem}.png"
    label = cv2.imread(str(path), cv2.IMREAD_UNCHANGED) if path.exists() else None
    if label is None or label.dtype != np.uint8 or label.ndim != 2:
        raise ValueError(
            f"{path}: no label image of 8 bit; make one for {name}, {UNCOUNTED} where nothing is known"
        )
    if label.shape != shape:
        raise ValueError(f"{path}: is {label.shape}, and {name} is {shape}; make them of one size")
    return np.asarray(label, np.uint8)


def simulated(model: Model, seen: Labelled) -> NDArray[np.float32]:
    """The events from each frame to the next as grids, (N - 1, BINS, H, W)."""
    model.advance(seen.frames[0], int(seen.t_us[0]))
    height, width = seen.frames.shape[1:]
    grids = []
    for before_us, t_us, frame in zip(
        seen.t_us[:-1].tolist(), seen.t_us[1:].tolist(), seen.frames[1:], strict=True
    ):
        grids.append(voxel_grid(model.advance(frame, t_us), width, height, before_us, t_us, BINS))
    return np.stack(grids)


def of_camera(seen: Labelled) -> NDArray[np.float32]:
    """As `simulated`, of real events. Raises ValueError where there are none."""
    if seen.footage is None:
        raise ValueError("the test folder has no events.txt: put the real camera's events there")
    events, t_us = seen.footage.events, seen.t_us
    edges = np.searchsorted(events["t"], t_us)
    height, width = seen.frames.shape[1:]
    return np.stack(
        [
            voxel_grid(events[edges[n - 1] : edges[n]], width, height, int(t_us[n - 1]), int(t_us[n]), BINS)
            for n in range(1, len(t_us))
        ]
    )


def clips_of(
    grids: NDArray[np.float32], labels: NDArray[np.uint8], count: int, size: int, seed: int
) -> Clips:
    """Pieces of WINDOWS windows, size x size pixels, at random. Raises ValueError where there are too few."""
    length, _, height, width = grids.shape
    if length < WINDOWS or height < size or width < size:
        raise ValueError(
            f"{length + 1} frames of {width} x {height} are too few or too small: "
            f"give {WINDOWS + 1} of {size} x {size}"
        )
    rng = np.random.default_rng(seed)
    cut_grids, cut_labels = [], []
    for _ in range(count):
        begin, top, left = (int(rng.integers(n + 1)) for n in (length - WINDOWS, height - size, width - size))
        part = np.s_[begin : begin + WINDOWS], np.s_[top : top + size, left : left + size]
        cut_grids.append(grids[part[0]][..., part[1][0], part[1][1]])
        cut_labels.append(labels[1:][part[0]][:, part[1][0], part[1][1]])
    return Clips(
        torch.from_numpy(np.stack(cut_grids)).half(), torch.from_numpy(np.stack(cut_labels)), len(grids)
    )


def loss(made: Tensor, wanted: Tensor) -> Tensor:
    """Cross entropy. made: (N, classes, H, W); wanted: (N, 1, H, W), classes."""
    return functional.cross_entropy(made, wanted[:, 0].long(), ignore_index=UNCOUNTED)


@torch.inference_mode()
def intersection_over_union(
    network: FireNet, grids: NDArray[np.float32], seen: Labelled
) -> tuple[float, float]:
    """The mean over classes that occur, and the share of pixels that are right (Long et al., CVPR 2015)."""
    table = np.zeros((seen.classes, max(seen.classes, network.outputs)), np.int64)
    state = None
    for grid, label in zip(torch.from_numpy(grids), seen.labels[1:], strict=True):
        made, state = network(normalised(grid[None]), state)
        answer, counted = made[0].argmax(0).numpy(), label != UNCOUNTED
        np.add.at(table, (label[counted], answer[counted]), 1)
    right = np.diag(table)
    union = table.sum(1) + table.sum(0)[: len(right)] - right
    occurs = table.sum(1) > 0
    return float((right[occurs] / union[occurs]).mean()), float(right.sum() / max(1, table.sum()))
