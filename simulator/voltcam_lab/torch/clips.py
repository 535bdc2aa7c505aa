"""A data set without storage: each clip is simulated when it is asked for."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch.utils.data import IterableDataset, get_worker_info

from voltcam_simulator import EVENT, Camera, Simulator
from voltcam_simulator.effect import Events

from ..drawn_camera import CameraDistribution
from ..models.model import Model
from .clip import ClipShape, Representation, WindowedClip, images_at
from .scenery import Scenery

Sensor = Callable[[int, int, float, np.random.Generator], Model]
"""(width, height, exponent from grey levels to light, random numbers) -> what gives events."""

MOST_WORKERS = 1024


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
        self.shape = ClipShape(width, height, windows, window_us, representation, bins, tau_us)
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
            yield self.shape.tensors(self.clip(epoch, number))

    def clip(self, epoch: int, number: int) -> WindowedClip:
        """One clip, whoever asks."""
        rng = np.random.default_rng([self.seed, epoch, number])
        of_scenery, of_sensor = rng.spawn(2)
        shape = self.shape
        events = [np.empty(0, EVENT)]

        def simulated() -> Iterator[tuple[NDArray[Any], int]]:
            """The frames, t_us from the first; their events go into `events`."""
            sensor: Model | None = None
            first_us = 0
            for frame in self._scenery.clip(shape.width, shape.height, shape.span_us, of_scenery):
                if sensor is None:
                    sensor = self._sensor(shape.width, shape.height, frame.gamma, of_sensor)
                    first_us = frame.t_us
                events.append(sensor.advance(frame.image, frame.t_us - first_us))
                yield frame.image, frame.t_us - first_us

        ends_us = [shape.window_us * (window + 1) for window in range(shape.windows)]
        images = np.stack(list(images_at(ends_us, simulated())))
        return shape.cut(np.concatenate(events), images)


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
