"""The test rig: the model run on a recording's scene, and what the battery sees of it."""

import os
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import EVENT, Parameters, Simulator

from ..battery import COUNTS, Setting, observe
from .lights import LIGHTS, light_behind

Values = NDArray[np.float64]


class Rig:
    """Runs the model on one scene. The same parameters and seed give the same noise: runs may be compared."""

    def __init__(self, setting: Setting, threads: int | None = None) -> None:
        self.setting = setting
        self._threads = threads or os.cpu_count() or 1

    @cached_property
    def _known(self) -> NDArray[np.bool_]:
        return self.setting.scene.trusted()

    @cached_property
    def _lights(self) -> list[list[tuple[NDArray[np.float32], int]]]:
        return [list(light_behind(self.setting.scene, version)) for version in range(len(LIGHTS))]

    def run(self, parameters: Parameters, seed: int) -> Values:
        """(PARTS, n) what the battery sees of one run, comparable."""
        return self.observe(self.events(parameters, seed))

    def observe(self, events: NDArray[np.void]) -> Values:
        """(PARTS, n) what the battery sees of events, `in_trusted_light`."""
        return comparable(observe(self.setting, self.in_trusted_light(events)).values)

    def in_trusted_light(self, events: NDArray[np.void]) -> NDArray[np.void]:
        """Those events that come where the light is known well enough (`Scene.trusted`)."""
        scene = self.setting.scene
        inside = events[(events["t"] >= scene.taken_us[0]) & (events["t"] <= scene.taken_us[-1])]
        gap = np.searchsorted(scene.taken_us, inside["t"], side="right") - 1
        last = len(scene.taken_us) - 2
        pixel = inside["y"].astype(np.int64) * scene.width + inside["x"]
        found: NDArray[np.void] = inside[self._known[np.minimum(gap, last), pixel]]
        return found

    def events(self, parameters: Parameters, seed: int) -> NDArray[np.void]:
        """The events of one run."""
        scene = self.setting.scene
        simulator = Simulator(scene.width, scene.height, parameters, seed=seed)
        found = [simulator.advance(image, t_us) for image, t_us in self._lights[seed % len(LIGHTS)]]
        return np.concatenate([np.empty(0, EVENT), *found])

    def runs(self, jobs: Iterable[tuple[Parameters, int]]) -> list[Values]:
        """Many runs, on all cores."""
        jobs = list(jobs)
        _ = self._lights  # before there are threads that would each make them
        with ThreadPoolExecutor(self._threads) as pool:
            return list(pool.map(lambda job: self.run(*job), jobs))

    def means(self, many: Sequence[Parameters], seeds: Sequence[int]) -> list[Values]:
        """Of each parameter set, the mean over the seeds."""
        found = self.runs((parameters, seed) for parameters in many for seed in seeds)
        n = len(seeds)
        return [np.mean(found[n * k : n * (k + 1)], axis=0) for k in range(len(many))]


def comparable(values: Values) -> Values:
    """Counts n as 2 sqrt(n + 3/8), whose spread does not depend on n (Anscombe 1948); the rest as it is."""
    return np.where(COUNTS, 2 * np.sqrt(np.maximum(values, 0) + 0.375), values)
