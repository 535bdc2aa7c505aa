"""The test rig: a camera simulated on a recording's scene, and the statistics of its events."""

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property, lru_cache
from itertools import groupby
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters, Simulator

from ...models.run_up import run_up
from ...statistics import COUNTS, Setting, Values, observe
from ..catalogue.entries import acts_across_columns, lead_in_us
from .lights import light_behind
from .settings import DEFAULT_RIG, RigSettings

Events = NDArray[np.void]
TimedImage = tuple[NDArray[np.float32], int]
Lights = tuple[NDArray[np.float32], list[int]]
"""(images, H, W) DN and their times [us]."""
Job = tuple[Parameters, tuple[int, ...], bool, bool]
"""What `Rig.run` is asked for."""
Item = TypeVar("Item")
Made = TypeVar("Made")

REMEMBERED = 1500  # batches, some 150 MB: a fit begins where another one has been. No result depends on it
GUTTER = 1  # dark columns between sensors side by side: with one, no event of one is a neighbour of the next


class Rig:
    """Runs the model on one scene. The same parameters and seeds give the same noise: runs may be compared.

    Runs that see different versions of the light are one run of a sensor as wide as all of theirs, which
    costs half as much: seeds come in batches of `versions`. Rows stay rows, for effects that scan them.
    """

    def __init__(
        self, setting: Setting, settings: RigSettings = DEFAULT_RIG, lights: Lights | None = None
    ) -> None:
        self.setting, self.settings = setting, settings
        if lights is not None:
            self.lights = lights

    @property
    def versions(self) -> int:
        """How many versions of the light there are."""
        return self.settings.versions

    @property
    def light_is_guessed(self) -> bool:
        """Whether light between frames goes along a motion, not on curves through them."""
        return not self.setting.scene.on_curves

    @cached_property
    def lights(self) -> Lights:
        """All versions of the light, side by side, each with a gutter on its right."""
        return self._lights()

    @cached_property
    def noisier_lights(self) -> Lights:
        """The same, all errors as many times as large as `RigSettings.noisier`."""
        return self._lights(noisier=True)

    def _lights(self, noisier: bool = False) -> Lights:
        scene, settings = self.setting.scene, self.settings
        versions = [light_behind(scene, version, settings, noisier) for version in range(self.versions)]
        moving = list(_moving(_side_by_side(images) for images in zip(*versions, strict=True)))
        return np.stack([image for image, _ in moving]), [t_us for _, t_us in moving]

    @cached_property
    def _run(self) -> Any:
        """`run`, which remembers."""
        return lru_cache(REMEMBERED)(self.run)

    def run(
        self, parameters: Parameters, seeds: Sequence[int], apart: bool = False, noisier: bool = False
    ) -> Values:
        """(seeds, PARTS, n) statistics of a batch of runs, comparable; see `events`."""
        return np.stack([self.observe(events) for events in self.events(parameters, seeds, apart, noisier)])

    def observe(self, events: Events) -> Values:
        """(PARTS, n) statistics of events, `in_trusted_light`."""
        return comparable(observe(self.setting, events).values)

    def in_trusted_light(self, events: Events) -> Events:
        """Those events that come where the light is known well enough (`known_light`)."""
        return self.setting.known.where(events)

    def events(
        self, parameters: Parameters, seeds: Sequence[int], apart: bool = False, noisier: bool = False
    ) -> list[Events]:
        """The events of each run of a batch. seeds: in sequence, of one batch.

        apart: each on a sensor of its own, as those whose columns share an effect are anyway. noisier: they
        see `noisier_lights`.
        """
        if apart or acts_across_columns(parameters):
            return [self._simulated(parameters, seed, 1, noisier) for seed in seeds]
        width, events = self.setting.scene.width, self._simulated(parameters, seeds[0], len(seeds), noisier)
        x, found = np.ascontiguousarray(events["x"]), []
        for left in range(0, len(seeds) * (width + GUTTER), width + GUTTER):
            own = events.compress((x >= left) & (x < left + width))  # 8 times as fast as by an index
            own["x"] -= left
            found.append(own)
        return found

    def _simulated(self, parameters: Parameters, seed: int, copies: int, noisier: bool) -> Events:
        scene = self.setting.scene
        left = seed % self.versions * (scene.width + GUTTER)
        columns = slice(left, left + copies * (scene.width + GUTTER) - GUTTER)
        simulator = Simulator(columns.stop - left, scene.height, parameters, seed=seed)
        lights = self.noisier_lights if noisier else self.lights
        images, times_us = lights[0][:, :, columns], lights[1]
        simulator.advance_along(run_up(images, times_us, self.settings.lead_in_us, lead_in_us(parameters)))
        end = images[-1], times_us[-1] + self.settings.lead_out_us
        return simulator.advance_along([*zip(images, times_us, strict=True), end])

    def runs(
        self, many: Sequence[Parameters], seeds: Sequence[int], apart: bool = False, noisier: bool = False
    ) -> list[Values]:
        """Of each parameter set, (seeds, PARTS, n): all runs."""
        batches = [tuple(batch) for _, batch in groupby(seeds, lambda seed: seed // self.versions)]
        jobs = [(parameters, batch, apart, noisier) for parameters in many for batch in batches]
        found = self.each(self.remembered, jobs)
        n = len(batches)
        return [np.concatenate(found[n * k : n * (k + 1)]) for k in range(len(many))]

    def remembered(self, job: Job) -> Values:
        """What `run` gives, simulated once."""
        values: Values = self._run(*job)
        return values

    def each(self, function: Callable[[Item], Made], items: Sequence[Item]) -> list[Made]:
        """The function, which asks for runs, of each item; a rig with workers does several at a time."""
        return [function(item) for item in items]

    def means(
        self, many: Sequence[Parameters], seeds: Sequence[int], apart: bool = False, noisier: bool = False
    ) -> list[Values]:
        """Of each parameter set, the mean over the seeds."""
        return [runs.mean(axis=0) for runs in self.runs(many, seeds, apart, noisier)]

    def changes(self, here: Parameters, there: Sequence[Parameters], seeds: Sequence[int]) -> list[Values]:
        """What each of the parameter sets there changes in the mean, with common noise."""
        base = {
            apart: self.means([here], seeds, apart)[0]
            for apart in sorted({acts_across_columns(one) for one in there})
        }
        means = self.means(there, seeds)
        return [mean - base[acts_across_columns(one)] for mean, one in zip(means, there, strict=True)]


def _side_by_side(images: Sequence[TimedImage]) -> TimedImage:
    height, width = images[0][0].shape
    joined = np.zeros((height, len(images), width + GUTTER), np.float32)
    for n, (image, _) in enumerate(images):
        joined[:, n, :width] = image
    return joined.reshape(height, -1), images[0][1]


def _moving(light: Iterator[TimedImage]) -> Iterator[TimedImage]:
    """Without the images between two others that are the same: nothing happens there."""
    former, skipped = next(light), None
    yield former
    for image, t_us in light:
        if np.array_equal(image, former[0]):
            skipped = image, t_us
            continue
        if skipped is not None:
            yield skipped
        former, skipped = (image, t_us), None
        yield former
    if skipped is not None:
        yield skipped


def comparable(values: Values) -> Values:
    """Counts n as 2 sqrt(n + 3/8), whose spread does not depend on n (Anscombe 1948); the rest as it is."""
    return np.where(COUNTS, 2 * np.sqrt(np.maximum(values, 0) + 0.375), values)
