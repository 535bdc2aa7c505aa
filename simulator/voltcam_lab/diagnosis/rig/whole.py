"""The whole sensor, simulated on the light that its frames may have been taken of."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, islice, takewhile

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters, Simulator
from voltcam_simulator.effect import Events

from ...dependence.clock import clock_of
from ...dependence.covariates import Look
from ...dependence.told_apart import STEPS, Telling, ToldApart, told_apart
from ...distances import FrameLight, Region
from ...distances.goal import Goal
from ...light.known import KnownLight
from ...light.scene import Scene, scene_of
from ...models.model import MODELS, simulate
from ...models.run_up import run_up
from ...recordings import Footage
from ..catalogue.entries import lead_in_us
from .lights import known_light, light_behind
from .settings import RigSettings

SEEDS = 1 << 19  # of these runs, away from those of the search
COMPARED = 2  # runs that are held against the others, for what the light leaves open
NOTICEABLE = 3 / 1000
"""Nats an event: who sees a thousand events is 20 times (3 nats) surer than before. Less, nobody notices."""
SURE = 36.0
"""Nats of all events. Measured: 5 % of 42 recordings without an effect have more than 32."""
RARELY = -math.log(0.05)
"""Times its mean, what is exponential is larger in one of twenty recordings."""


@dataclass(frozen=True, eq=False)
class LeftOpen:
    """What tells runs on one light from runs on others, where nothing is missing: so much is the light's, not
    the camera's. told: runs on versions of it. larger: with larger errors (`RigSettings.noisier`), as nobody
    knows better how large they are; none: that makes no difference."""

    told: tuple[ToldApart, ...]
    larger: tuple[ToldApart, ...] = ()

    @property
    def floor(self) -> float:
        """Nats an event that the light leaves open, its errors as told."""
        return _mean(self.told)

    @property
    def more(self) -> float:
        """Nats an event that larger errors leave besides."""
        return float(np.fmax(_mean(self.larger) - self.floor, 0.0)) if self.larger else 0.0


@dataclass(frozen=True, eq=False)
class Remains:
    """What tells the recording from simulated runs. look: by what, and with which clock."""

    told: ToldApart
    look: Look
    by_light: LeftOpen

    @property
    def evidence(self) -> float:
        """Of all recorded events that were looked at, beyond the light as told [nats]."""
        return self.noticed * self.told.events[0]

    @property
    def by_larger_errors(self) -> float:
        """What larger errors of the light leave of that in the mean [nats]."""
        return self.by_light.more * self.told.events[0]

    @property
    def noticed(self) -> float:
        """Nats an event beyond the light as told, by which anybody could tell the recording from a simulated
        one."""
        return self.told.total - self.by_light.floor

    @property
    def noticeable(self) -> bool:
        """Whether that is enough to matter; where too few events tell, it may be."""
        return not self.noticed <= NOTICEABLE + RARELY * self.by_light.more

    @property
    def telling(self) -> tuple[Telling, ...]:
        """The steps that matter by themselves, or that all events together leave no doubt of, beyond what
        larger errors of the light leave in 19 of 20 recordings."""
        least = min(NOTICEABLE, SURE / max(self.told.events[0], 1)) + RARELY * self.by_light.more
        return tuple(step for step in self.told.steps if step.gain > least)


def _mean(several: tuple[ToldApart, ...]) -> float:
    return float(np.mean([one.total for one in several]))


@dataclass(frozen=True, eq=False)
class WholeSensor:
    """A recording of all columns, on the clock of the diagnosis, and its light, made when asked for."""

    footage: Footage
    light: Callable[[], Scene]
    settings: RigSettings
    seed: int = 0

    @cached_property
    def scene(self) -> Scene:
        """The light of the frames and between them."""
        return self.light()

    @cached_property
    def _served(self) -> Scene:
        """The light as `serve` would have it."""
        return scene_of(self.footage.frames, self.footage.frame_t_us, "auto")

    @cached_property
    def _known(self) -> KnownLight:
        return known_light(self.scene, self.footage.events)

    @cached_property
    def recorded(self) -> Events:
        """What was recorded where the light is known: nothing else is anybody's past, and `events` has as
        little."""
        return self._known.where(self.footage.events)

    @cached_property
    def look(self) -> Look:
        """Classes for what events may depend on."""
        footage = self.footage
        light = FrameLight(footage.frames, footage.frame_t_us)
        return Look.at(self.recorded, footage.width, footage.height, light)

    def remains(
        self, parameters: Parameters, steps: int = STEPS, later_than_us: float = -np.inf,
        by_light: LeftOpen | None = None,
    ) -> Remains:  # fmt: skip
        """By what the recording can still be told from a camera with these parameters, of events later than
        a time. by_light: what the light leaves open, if it is known from nearly such a camera."""
        runs = [self.events(parameters, version) for version in range(self.settings.versions)]

        def chosen(events: Events) -> NDArray[np.bool_]:
            late: NDArray[np.bool_] = events["t"] > later_than_us
            return self.judged(events) & late

        real = self.recorded
        t_us = self.footage.frame_t_us
        frame_us = float(t_us[-1] - t_us[0]) / (len(t_us) - 1)
        look = self.look.finer(clock_of(real, runs, self.footage.height, frame_us))
        if by_light is None:
            larger = [self.events(parameters, len(runs) + k, noisier=True) for k in range(COMPARED)]
            by_light = LeftOpen(*(
                tuple(
                    told_apart(some[k], [*runs[:k], *runs[k + 1 :]], look, chosen, steps)
                    for k in range(COMPARED)
                )
                for some in (runs, larger)
            ))  # fmt: skip
        return Remains(told_apart(real, runs, look, chosen, steps), look, by_light)

    def events(
        self, parameters: Parameters, version: int, until_us: float = np.inf, noisier: bool = False
    ) -> Events:
        """One run, on a version of the light: what of it is where the light is known. noisier: as of
        `light_behind`."""
        scene = self.scene
        simulator = Simulator(scene.width, scene.height, parameters, seed=SEEDS + version + self.seed)
        run_up_us = self.settings.lead_in_us
        light = light_behind(scene, version, self.settings, noisier)
        head = list(islice(light, int(np.searchsorted(scene.t_us, scene.t_us[0] + run_up_us)) + 1))
        images, times_us = zip(*head, strict=True)
        simulator.advance_along(run_up(images, times_us, run_up_us, lead_in_us(parameters)))
        seen = takewhile(lambda one: one[1] <= until_us, chain(head, light))
        return self._known.where(simulator.advance_along(seen))

    def difference(self, parameters: Parameters, run: int) -> float:
        """How far a run with these parameters is from the recording, by all pixels and in any light, known or
        not, while there are frames: `Goal.score`, 0 for the recording itself.

        The run sees the frames as `serve` takes them, with their noise.
        """
        footage, seed = self.footage, SEEDS + self.seed + run
        model = MODELS["exact"](footage.width, footage.height, parameters, seed)
        return float(self._goal.score(simulate(model, self._served)))

    @cached_property
    def _goal(self) -> Goal:
        footage, t_us = self.footage, self.footage.frame_t_us
        region = Region.whole(footage.width, footage.height, int(t_us[0]), int(t_us[-1]))
        return Goal(footage.events, region, FrameLight(footage.frames, t_us))

    def judged(self, events: Events) -> NDArray[np.bool_]:
        """(n,): of `recorded` ones or those of a run, which are not made by light that is not known."""
        return self._known.settled(events)
