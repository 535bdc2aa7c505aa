"""What a clip is: windows of events, the image at each window's end, and what becomes of them."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal, get_args

import numpy as np
import torch
from numpy.typing import NDArray

from voltcam_simulator.effect import Events

from ..representations import event_frame, time_surface, voxel_grid

Representation = Literal["voxel_grid", "time_surface", "event_frame", "events"]


@dataclass(frozen=True)
class WindowedClip:
    """Of one clip, before it becomes tensors.

    events: of each window, t in us from the window's start. images: (windows, H, W) float32, what was seen
    at each window's end.
    """

    events: list[Events]
    images: NDArray[np.float32]


@dataclass(frozen=True)
class ClipShape:
    """How large clips are, and what a window becomes: see `EventClips`. Raises ValueError."""

    width: int
    height: int
    windows: int
    window_us: int
    representation: Representation | Callable[[Events], Any]
    bins: int
    tau_us: float

    def __post_init__(self) -> None:
        for name in ("width", "height", "windows", "window_us", "bins"):
            value = getattr(self, name)
            if value < 1:
                raise ValueError(f"{name} is a whole number from 1, not {value}")
        if not callable(self.representation) and self.representation not in get_args(Representation):
            known = ", ".join(get_args(Representation))
            raise ValueError(f"there is no representation {self.representation!r}: there are {known}")

    @property
    def span_us(self) -> int:
        return self.windows * self.window_us

    def cut(self, events: Events, images: NDArray[np.float32]) -> WindowedClip:
        """Into windows. events: t from the clip's start."""
        edges = np.searchsorted(events["t"], self.window_us * np.arange(self.windows + 1))
        split = [events[a:b].copy() for a, b in pairwise(edges)]
        for window, each in enumerate(split):
            each["t"] -= window * self.window_us
        return WindowedClip(split, images)

    def represented(self, events: Events) -> Any:
        """What a window's events become, as an array where it is one."""
        size = self.width, self.height
        if callable(self.representation):
            return self.representation(events)
        if self.representation == "voxel_grid":
            return voxel_grid(events, *size, 0, self.window_us, self.bins)
        if self.representation == "time_surface":
            return time_surface(events, *size, self.window_us, self.tau_us)
        if self.representation == "event_frame":
            return event_frame(events, *size)
        return np.stack([events[name].astype(np.int64) for name in "txyp"], axis=-1)

    def tensors(self, clip: WindowedClip) -> dict[str, Any]:
        """An item of a data set."""
        made = [self.represented(each) for each in clip.events]
        return {"events": _together(made), "images": torch.from_numpy(clip.images)}


def images_at(
    times_us: Iterable[int], frames: Iterable[tuple[NDArray[Any], int]]
) -> Iterable[NDArray[np.float32]]:
    """The images at those times, in straight lines between frames (image, t_us). Both are in order of time; a
    frame is taken only when it is needed. Ends early where frames do.
    """
    coming = iter(frames)
    before: tuple[NDArray[Any], int] | None = None
    after = next(coming, None)
    for t_us in times_us:
        while after is not None and after[1] < t_us:
            before, after = after, next(coming, None)
        if after is None:
            return
        image, later_us = after
        if before is None or later_us == t_us:
            yield image.astype(np.float32)
        else:
            share = np.float32((t_us - before[1]) / (later_us - before[1]))
            yield (before[0] * (1 - share) + image * share).astype(np.float32)


def _together(made: list[Any]) -> Any:
    """One tensor where all are arrays of one shape, else a list."""
    if not all(isinstance(each, np.ndarray) and each.dtype.names is None for each in made):
        return made
    if len({each.shape for each in made}) == 1:
        return torch.from_numpy(np.stack(made))
    return [torch.from_numpy(each) for each in made]
