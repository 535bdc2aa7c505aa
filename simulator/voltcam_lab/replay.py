"""A scene simulated again and again, where and when it is looked at only."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import EVENT, Parameters, Simulator
from voltcam_simulator.effect import Events

from .distances import Region
from .scene import Scene

WARM_UP_US = 100_000  # of light before each stretch


@dataclass(frozen=True, eq=False)
class Replay:
    """images (N, H, columns): the pixels of a region, row by row, moved together; x (H, columns): where they
    came from, -1 where a row has fewer; t_us (N,); resumes (N,): the image comes after a pause."""

    images: NDArray[np.float32]
    x: NDArray[np.int64]
    t_us: NDArray[np.int64]
    resumes: NDArray[np.bool_]

    @classmethod
    def of(cls, scene: Scene, region: Region) -> Self:
        """The scene as `region` needs it."""
        columns = int(region.pixels.sum(axis=1).max())
        left = np.argsort(~region.pixels, axis=1, kind="stable")[:, :columns]
        used = np.take_along_axis(region.pixels, left, axis=1)
        begins, ends = region.times[:, 0] - WARM_UP_US, region.times[:, 1]
        t_us = scene.t_us[:, None]
        wanted = np.flatnonzero(((t_us >= begins) & (t_us <= ends)).any(axis=1))
        images = np.take_along_axis(scene.images[wanted], left[None], axis=2)
        resumes = np.diff(wanted, prepend=-2) > 1
        return cls(images, np.where(used, left, -1), scene.t_us[wanted], resumes)

    def events(self, parameters: Parameters, seed: int) -> Events:
        """What a camera gives out, at the pixels' own places."""
        height, columns = self.x.shape
        simulator = Simulator(columns, height, parameters, "exact", seed, threads=2)
        parts = [np.empty(0, EVENT)]
        for image, t_us, resumes in zip(self.images, self.t_us.tolist(), self.resumes, strict=True):
            if resumes:
                simulator.jump(image, t_us)
            else:
                parts.append(simulator.advance(image, t_us))
        events = np.concatenate(parts)
        x = self.x[events["y"], events["x"]]
        events["x"] = np.maximum(x, 0)
        kept: Events = events[x >= 0]
        return kept
