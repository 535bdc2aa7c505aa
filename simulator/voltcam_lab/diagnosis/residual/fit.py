"""Generic terms for what has no name: their numbers found on the earlier part of a recording, by simulation
of all pixels, and judged on the later part."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters
from voltcam_simulator.effect import Events

from ...dependence.covariates import Kind
from ...dependence.told_apart import Telling, told_by
from ..rig.whole import NOTICEABLE, Remains, WholeSensor
from .begin import beginnings, covariates_of, fits
from .shapes import Shape

EARLIER = 0.6  # of the recording: numbers are found there
FACTORS = (1.8, 1.3)  # by which numbers are moved, one after the other
MOST_TERMS = 2
VERSION = 0  # of the light, when numbers are found: one run each time, with the same random numbers

Say = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class GenericTerm:
    """A term of a kind. before, after: by what the later part can be told from the model without and with
    it. parameters: with it."""

    shape: Shape
    before: Remains
    after: Remains
    parameters: Parameters

    @property
    def removed(self) -> float:
        """Nats an event fewer that tell, held out."""
        return self.before.noticed - self.after.noticed

    @property
    def share(self) -> float:
        """Of what could be removed."""
        return self.removed / max(self.before.noticed, 1e-9)


def generic_terms(
    sensor: WholeSensor, parameters: Parameters, remains: Remains, say: Say
) -> tuple[GenericTerm, ...]:
    """The terms, one a kind, that take away what anybody would notice, on the later part of the recording.

    parameters: of the model. remains: by what the recording is told from it, all of the time.
    """
    found: list[GenericTerm] = []
    tried: set[Kind] = set()
    split_us = _split_us(sensor)
    before: Remains | None = None
    while len(tried) < MOST_TERMS and (step := _next(remains, tried)):
        tried.add(step.covariate.kind)
        say(f"Looking for a term of unknown origin: {step.covariate.title}.")
        before = before or sensor.remains(parameters, later_than_us=split_us)
        if np.isnan(before.noticed):
            say("None can be judged: too few events of the later part come where the light is known.")
            break
        shape = _fitted(sensor, parameters, remains, step.covariate.kind)
        if shape is None:
            continue
        after = sensor.remains(shape.on(parameters), later_than_us=split_us, by_light=before.by_light)
        term = GenericTerm(shape, before, after, shape.on(parameters))
        say(
            f"{shape.formula()}: {1000 * before.noticed:.1f} millinats an event become"
            f" {1000 * after.noticed:.1f} on the later part."
        )
        if term.removed > NOTICEABLE:
            found.append(term)
            parameters, before = term.parameters, after
            if len(tried) < MOST_TERMS and after.noticeable:
                remains = sensor.remains(parameters, by_light=remains.by_light)
    return tuple(found)


def _next(remains: Remains, tried: set[Kind]) -> Telling | None:
    """What matters most of the kinds that have a term and were not tried."""
    if not remains.noticeable:
        return None
    left = (one for one in remains.telling if one.covariate.kind not in tried)
    return next((one for one in left if fits(one)), None)


def _split_us(sensor: WholeSensor) -> float:
    t_us = sensor.scene.t_us
    return float(t_us[0] + EARLIER * (t_us[-1] - t_us[0]))


def _fitted(sensor: WholeSensor, parameters: Parameters, remains: Remains, kind: Kind) -> Shape | None:
    """The term and its numbers by which the earlier part is least told from simulated events, of all
    beginnings the best one moved on; None: without any it is told as little."""
    split_us, covariates = _split_us(sensor), covariates_of(kind)
    steps = [one for one in remains.told.steps if one.covariate.kind == kind and fits(one)]
    real, look = sensor.recorded, remains.look
    sides = look.width, look.height

    def chosen(events: Events) -> NDArray[np.bool_]:
        early: NDArray[np.bool_] = events["t"] <= split_us
        return sensor.judged(events) & early

    def told(camera: Parameters) -> float:
        run = sensor.events(camera, VERSION, until_us=split_us)
        return told_by(real, [run], look, chosen, covariates)

    tries = [
        (told(shape.on(parameters)), shape, name)
        for step in steps
        for begin, name, values in beginnings(step, parameters, sides, look.clock)
        for shape in (begin.with_number(name, value) for value in values)
    ]
    if not tries:
        return None
    tell, best, name = min(tries, key=lambda one: one[0])
    best, tell = _moved(best, tell, name, lambda one: told(one.on(parameters)))
    return best if tell < told(parameters) else None


def _moved(shape: Shape, tell: float, first: str, told: Callable[[Shape], float]) -> tuple[Shape, float]:
    """Each number moved either way, by less and less, where that makes events harder to tell."""
    names = [first, *(name for name in shape.numbers if name != first)]
    for factor in FACTORS:
        for name in names:
            for moved in shape.moves(name, factor):
                if moved != shape and (now := told(moved)) < tell:
                    shape, tell = moved, now
                    break
    return shape, tell
