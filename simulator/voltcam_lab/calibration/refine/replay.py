"""A scene simulated again and again, where and when it is looked at only."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters, Simulator
from voltcam_simulator.effect import Events

from ...distances import Region
from ...light.scene import Scene

WARM_UP_US = 50_000  # of light before each stretch


@dataclass(frozen=True, eq=False)
class Replay:
    """images (N, H, columns): the pixels of a region, row by row, moved together; x (H, columns): where they
    came from, -1 where a row has fewer; t_us (N,). Between the region's stretches of time there are only the
    frames that were taken: enough for voltages to go on from."""

    images: NDArray[np.float32]
    x: NDArray[np.int64]
    t_us: NDArray[np.int64]

    @classmethod
    def of(cls, scene: Scene, region: Region) -> Self:
        """The scene as `region` needs it."""
        columns = int(region.pixels.sum(axis=1).max())
        left = np.argsort(~region.pixels, axis=1, kind="stable")[:, :columns]
        used = np.take_along_axis(region.pixels, left, axis=1)
        begins, ends = region.times[:, 0] - WARM_UP_US, region.times[:, 1]
        t_us = scene.t_us[:, None]
        looked_at = ((t_us >= begins) & (t_us <= ends)).any(axis=1)
        since = (scene.t_us >= begins.min()) & (scene.t_us <= ends.max())
        wanted = np.flatnonzero(looked_at | (since & np.isin(scene.t_us, scene.taken_us)))
        images = np.take_along_axis(scene.images[wanted], left[None], axis=2)
        return cls(images, np.where(used, left, -1), scene.t_us[wanted])

    def events(self, parameters: Parameters, seed: int) -> Events:
        """What a camera gives out, at the pixels' own places."""
        height, columns = self.x.shape
        simulator = Simulator(columns, height, parameters, "exact", seed)
        events = simulator.advance_along(zip(self.images, self.t_us.tolist(), strict=True))
        x = self.x[events["y"], events["x"]]
        events["x"] = np.maximum(x, 0)
        kept: Events = events[x >= 0]
        return kept
