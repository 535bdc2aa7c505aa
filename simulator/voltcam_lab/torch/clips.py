"""A data set without storage: each clip is simulated when it is asked for."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import count, pairwise
from pathlib import Path
from typing import Any, Literal

import numpy as np
import torch
from numpy.typing import NDArray
from torch.utils.data import IterableDataset, get_worker_info

from voltcam_simulator import EVENT, Camera, Simulator
from voltcam_simulator.effect import Events

from ..drawn_camera import CameraDistribution
from ..models.model import Model
from ..representations import event_frame, time_surface, voxel_grid
from .scenery import Scenery

Representation = Literal["voxel_grid", "time_surface", "event_frame", "events"]
Sensor = Callable[[int, int, float, np.random.Generator], Model]
"""(width, height, exponent from grey levels to light, random numbers) -> what gives events."""

MOST_WORKERS = 1024


@dataclass(frozen=True)
class Clip:
    """Of one clip, before it becomes tensors.

    events: of each window, t in us from the window's start. images: (windows, H, W) float32, what was seen
    at each window's end.
    """

    events: list[Events]
    images: NDArray[np.float32]


class EventClips(IterableDataset[dict[str, Any]]):
    """Clips of events, and the images that belong to them, simulated in the loader's workers.

    - `scenery`: what is looked at: `Photographs`, `Videos`, or what has their `clip`.
    - `camera`: a preset's name or a camera file, a `Camera`, a `CameraDistribution` from which one is drawn
      for each clip, or a function that makes any other model: see `Sensor`.
    - `width`, `height`, `windows`, `window_us`: a clip. Only so much is drawn and simulated: the sensor has
      the clip's size, with its own fixed pattern.
    - `representation`: what a window becomes: `voxel_grid` (bins, H, W), `time_surface` (2, H, W),
      `event_frame` (2, H, W), `events` (N, 4) int64 of t, x, y, p with t from the window's start; or a
      function of the window's events, as tonic's transforms are.
    - `bins`, `tau_us`: of voxel grids and of time surfaces.
    - `clips`: in a pass; None: without end.
    - `seed`: of everything.

    An item is {"events": one tensor (windows, ...), or a list of windows where these differ in length or are
    no arrays, "images": (windows, H, W) float32 at the windows' ends}. Give raw events `batch_size=None`, or
    a `collate_fn` of your own.

    The clip with a number is the same on any number of workers; worker w of n makes the numbers w, w + n...
    Each pass over the data set is another epoch, with other clips; `set_epoch` says which comes next. Raises
    ValueError.
    """

    def __init__(
        self,
        scenery: Scenery,
        camera: str | Path | Camera | CameraDistribution | Sensor,
        *,
        width: int = 128,
        height: int = 128,
        windows: int = 20,
        window_us: int = 40_000,
        representation: Representation | Callable[[Events], Any] = "voxel_grid",
        bins: int = 5,
        tau_us: float = 30_000.0,
        clips: int | None = None,
        seed: int = 0,
    ) -> None:
        super().__init__()
        for name, value in (("width", width), ("height", height), ("windows", windows), ("bins", bins)):
            if value < 1:
                raise ValueError(f"{name} is a whole number from 1, not {value}")
        if window_us < 1:
            raise ValueError(f"window_us is a whole number from 1, not {window_us}")
        if not callable(representation) and representation not in Representation.__args__:  # type: ignore[attr-defined]
            raise ValueError(f"there is no representation {representation!r}")
        self.width, self.height, self.windows, self.window_us = width, height, windows, window_us
        self.representation, self.bins, self.tau_us = representation, bins, tau_us
        self.clips, self.seed = clips, seed
        self._scenery = scenery
        self._sensor: Sensor = camera if _makes(camera) else _drawn_from(camera)  # type: ignore[assignment,arg-type]
        # A worker is a copy; what it counts must outlive it.
        self._passes = torch.zeros(MOST_WORKERS, dtype=torch.int64).share_memory_()

    def set_epoch(self, epoch: int) -> None:
        """The next pass is this one; between passes only."""
        self._passes.fill_(epoch)

    def __iter__(self) -> Iterator[dict[str, Any]]:
        worker = get_worker_info()
        first, step = (worker.id, worker.num_workers) if worker is not None else (0, 1)
        epoch = int(self._passes[first])
        self._passes[first] += 1
        numbers = count(first, step) if self.clips is None else range(first, self.clips, step)
        for number in numbers:
            yield self._tensors(self.clip(epoch, number))

    def clip(self, epoch: int, number: int) -> Clip:
        """One clip, whoever asks."""
        rng = np.random.default_rng([self.seed, epoch, number])
        of_scenery, of_sensor = rng.spawn(2)
        span_us = self.windows * self.window_us
        frames = self._scenery.clip(self.width, self.height, span_us, of_scenery)
        events: list[Events] = []
        images: list[NDArray[np.float32]] = []
        sensor: Model | None = None
        first_us = 0
        before: tuple[NDArray[Any], int] | None = None
        for frame in frames:
            if sensor is None:
                sensor, first_us = self._sensor(self.width, self.height, frame.gamma, of_sensor), frame.t_us
            t_us = frame.t_us - first_us
            events.append(sensor.advance(frame.image, t_us))
            while len(images) < self.windows and t_us >= (len(images) + 1) * self.window_us:
                images.append(_at((len(images) + 1) * self.window_us, before, (frame.image, t_us)))
            before = frame.image, t_us
            if len(images) == self.windows:
                break
        every = np.concatenate([np.empty(0, EVENT), *events])
        edges = np.searchsorted(every["t"], self.window_us * np.arange(self.windows + 1))
        split = [every[a:b].copy() for a, b in pairwise(edges)]
        for window, each in enumerate(split):
            each["t"] -= window * self.window_us
        return Clip(split, np.stack(images))

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

    def _tensors(self, clip: Clip) -> dict[str, Any]:
        made = [self.represented(each) for each in clip.events]
        return {"events": _together(made), "images": torch.from_numpy(clip.images)}


def _at(
    t_us: int, before: tuple[NDArray[Any], int] | None, after: tuple[NDArray[Any], int]
) -> NDArray[np.float32]:
    """The image at that time, in a straight line between two frames."""
    image, later_us = after
    if before is None or later_us == t_us:
        return image.astype(np.float32)
    share = np.float32((t_us - before[1]) / (later_us - before[1]))
    between = before[0] * (1 - share) + image * share
    return between.astype(np.float32)


def _together(made: list[Any]) -> Any:
    """One tensor where all are arrays of one shape, else a list."""
    if not all(isinstance(each, np.ndarray) and each.dtype.names is None for each in made):
        return made
    if len({each.shape for each in made}) == 1:
        return torch.from_numpy(np.stack(made))
    return [torch.from_numpy(each) for each in made]


def _makes(camera: object) -> bool:
    return callable(camera) and not isinstance(camera, Camera | CameraDistribution)


def _drawn_from(camera: str | Path | Camera | CameraDistribution) -> Sensor:
    if isinstance(camera, str | Path):
        camera = CameraDistribution.of(camera)
    if isinstance(camera, Camera):
        camera = CameraDistribution((camera,), ({},))
    return _DrawnSensor(camera)


@dataclass(frozen=True)
class _DrawnSensor:
    """A function that can be sent to a worker."""

    cameras: CameraDistribution

    def __call__(self, width: int, height: int, gamma: float, rng: np.random.Generator) -> Model:
        parameters = self.cameras.draw(rng).parameters.seen_through(gamma)
        return Simulator(width, height, parameters, "exact", int(rng.integers(2**31)), 1)
