"""Clips of recordings: data sets that were stored, and real cameras."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch.utils.data import Dataset

from voltcam_simulator.effect import Events

from ..recordings import load
from .clip import ClipShape, Representation, WindowedClip, images_at


class RecordedClips(Dataset[dict[str, Any]]):
    """A clip of each recording, at a random time and place: the same items as `EventClips` gives.

    recordings: files with events and frames in any format that `voltcam_client.formats.read` reads, such as
    `voltcam dataset make` writes with `frames`. The rest is as of `EventClips`. `set_epoch` has other places.

    An item raises FormatError or ValueError, a line that names its recording: unreadable, too short or small.
    """

    def __init__(
        self,
        recordings: Sequence[str | Path],
        *,
        width: int = 128,
        height: int = 128,
        windows: int = 20,
        window_us: int = 40_000,
        representation: Representation | Callable[[Events], Any] = "voxel_grid",
        bins: int = 5,
        tau_us: float = 30_000.0,
        seed: int = 0,
    ) -> None:
        self.shape = ClipShape(width, height, windows, window_us, representation, bins, tau_us)
        self.recordings, self.seed = list(recordings), seed
        self._epoch = torch.zeros(1, dtype=torch.int64).share_memory_()  # a worker is a copy

    def set_epoch(self, epoch: int) -> None:
        """The next pass is this one; between passes only."""
        self._epoch.fill_(epoch)

    def __len__(self) -> int:
        return len(self.recordings)

    def __getitem__(self, number: int) -> dict[str, Any]:
        return self.shape.tensors(self.clip(int(self._epoch), number))

    def clip(self, epoch: int, number: int) -> WindowedClip:
        """One clip, whoever asks."""
        shape, path = self.shape, self.recordings[number]
        footage = load(path)
        room_us = int(footage.frame_t_us[-1] - footage.frame_t_us[0]) - shape.span_us
        rows, columns = footage.frames.shape[1] - shape.height, footage.frames.shape[2] - shape.width
        if room_us < 0 or rows < 0 or columns < 0:
            span_s = (room_us + shape.span_us) * 1e-6
            raise ValueError(
                f"{path}: its frames are {footage.width} x {footage.height} over {span_s:g} s, less than a "
                f"clip of {shape.width} x {shape.height} over {shape.span_us * 1e-6:g} s: make clips smaller"
            )
        rng = np.random.default_rng([self.seed, epoch, number])
        begin_us = int(footage.frame_t_us[0]) + int(rng.integers(room_us + 1))
        top, left = int(rng.integers(rows + 1)), int(rng.integers(columns + 1))
        span = np.searchsorted(footage.events["t"], [begin_us, begin_us + shape.span_us])
        events = footage.events[slice(*span)]
        x, y = events["x"].astype(np.int64) - left, events["y"].astype(np.int64) - top
        inside = (x >= 0) & (x < shape.width) & (y >= 0) & (y < shape.height)
        events = events[inside].copy()
        events["t"] -= begin_us
        events["x"], events["y"] = x[inside], y[inside]
        here = footage.frames[:, top : top + shape.height, left : left + shape.width]
        ends_us = begin_us + shape.window_us * np.arange(1, shape.windows + 1)
        frames = zip(here, footage.frame_t_us.tolist(), strict=True)
        return shape.cut(events, np.stack(list(images_at(ends_us.tolist(), frames))))
