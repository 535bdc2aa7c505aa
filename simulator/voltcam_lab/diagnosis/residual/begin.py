"""Where the fit of a generic term begins: at the shape of the function that tells real events apart."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from voltcam_simulator import Parameters

from ...dependence.clock import RowClock
from ...dependence.covariates import (
    COVARIATES,
    DECADES_PER_BIN,
    FINER,
    PAST_BINS,
    PHASES,
    Covariate,
    Kind,
)
from ...dependence.told_apart import Telling
from ...dependence.words import peak
from .shapes import ClockShape, KickShape, PatternShape, Shape
from .waves import wave_of

ALIKE = 0.4  # of the stronger polarity's log ratio: what the other has to have to be kicked, too
CHANCES = (0.05, 0.15, 0.45)
SIZES = (0.05, 0.15, 0.4)  # nominal thresholds
CLOCK_SIZES = (0.02, 0.06, 0.2)
NARROWEST, WIDEST = 0.05, 1.0  # decades; as wide as the effects' parameters go
LONGEST_DELAY_US, STEEPEST_ROW_US = 1e6, 1e4  # the same
PHASE_STEPS = (-1 / 8, 0.0, 1 / 8)  # about where ON events are most too many
_CLOCKS_NAME = "clock"
_PLACES = ("x", "y", "patch", "lattice")
_BY_HEIGHT = (0.5, 1.0, 2.0)  # sizes of a pattern: rates go about as one over the threshold


class Beginning(NamedTuple):
    """A term to begin with, its number that matters most, and values of that to try."""

    shape: Shape
    name: str
    values: tuple[float, ...]


def fits(step: Telling) -> bool:
    """Whether there is a generic term of that kind and shape."""
    name, kind = step.covariate.name, step.covariate.kind
    if kind in ("own past", "neighbours"):
        last = peak(step)[2]
        return last < PAST_BINS - 1 and _signs(step) != (0, 0)
    return name in (_CLOCKS_NAME, *_PLACES)


def covariates_of(kind: Kind) -> list[Covariate]:
    """Those by which a term of a kind is judged while it is fitted."""
    if kind == "clock":
        return [Covariate(_CLOCKS_NAME, kind, "", PHASES)]
    return [one for one in (*COVARIATES, *FINER) if one.kind == kind]


def beginnings(
    step: Telling, parameters: Parameters, sides: tuple[int, int], clock: RowClock | None = None
) -> Iterator[Beginning]:
    """Terms to begin with. sides: width and height of the sensor. clock: that of a step that is one."""
    if step.covariate.name == _CLOCKS_NAME:
        if clock is not None and abs(clock.row_us) <= STEEPEST_ROW_US:
            yield from _clocks(step, clock)
    elif step.covariate.name in _PLACES:
        yield from _patterns(step, *sides)
    else:
        yield from _kicks(step, parameters)


def _kicks(step: Telling, parameters: Parameters) -> Iterator[Beginning]:
    """Where real events are too many, each may follow another with some chance, whatever the voltage: an
    echo. Or each voltage is moved by as much: a push, which makes events more or fewer."""
    kind, signs = step.covariate.kind, _signs(step)
    effect = "residual_coupling" if kind == "neighbours" else "residual_kick"
    delay_us, spread = _delay(step)
    comparator = parameters.comparator
    through = min(float(comparator.theta_on + comparator.theta_off), 10.0)  # sets an event off for sure
    fixed, moved = {"spread_decades": spread}, {"delay_us": delay_us}
    if peak(step)[3] > 0:
        echo = KickShape(kind, effect, fixed | {"size": through}, {"chance": CHANCES[0]} | moved, signs)
        yield Beginning(echo, "chance", CHANCES)
    push = KickShape(kind, effect, fixed | {"chance": 1.0}, {"size": SIZES[0]} | moved, signs)
    yield Beginning(push, "size", SIZES)


def _patterns(step: Telling, width: int, height: int) -> Iterator[Beginning]:
    """Thresholds that are lower where events are too many."""
    wave = wave_of(step, width, height)
    top = max(abs(wave.on), abs(wave.off))
    if top == 0:
        return
    signs = [-int(np.sign(one)) if abs(one) >= ALIKE * top else 0 for one in (wave.on, wave.off)]
    fixed = {"across_per_px": wave.across_per_px, "down_per_px": wave.down_per_px}
    numbers = {"size": top, "crest_turns": wave.crest_turns}
    shape = PatternShape(step.covariate.kind, "residual_pattern", fixed, numbers, (signs[0], signs[1]))
    yield Beginning(shape, "size", tuple(share * top for share in _BY_HEIGHT))


def _signs(step: Telling) -> tuple[int, int]:
    """Of the kicks after an ON and after an OFF event: up where ON events are too many or OFF too few."""
    _, first, last, top = peak(step)
    body = slice(first, last + 1)
    signs = {}
    for on in (False, True):
        share = step.share[int(on), body]
        ratio = float(np.average(step.function[int(on), body], weights=share + 1e-12))
        source = on == step.covariate.name.endswith("_same")
        strong = abs(ratio) >= ALIKE * abs(top)
        signs[source] = int(np.sign(ratio)) * (1 if on else -1) if strong else 0
    return signs[True], signs[False]


def _delay(step: Telling) -> tuple[float, float]:
    """(median delay [us], spread [decades]) of kicks whose bins a function's peak takes."""
    _, first, last, _ = peak(step)
    begin, end = (DECADES_PER_BIN * max(k, 0) for k in (first - 1, last))
    spread = min(max(float(end - begin) / 12**0.5, NARROWEST), WIDEST)
    return min(float(10 ** ((begin + end) / 2)), LONGEST_DELAY_US), spread


def _clocks(step: Telling, clock: RowClock) -> Iterator[Beginning]:
    """A kick up about where ON events are most too many against OFF events."""
    phase = (np.arange(PHASES) + 0.5) / PHASES
    wave = step.function * step.share
    turn = np.exp(2j * np.pi * phase)
    top = float(np.angle(((wave[1] - wave[0]) * turn).sum()) / (2 * np.pi))
    fixed = {"period_us": clock.period_us, "row_us": clock.row_us}
    for part in PHASE_STEPS:
        begin_us = (top + part) % 1.0 * clock.period_us
        numbers = {"size": CLOCK_SIZES[0], "begin_us": begin_us}
        yield Beginning(ClockShape("clock", "residual_clock", fixed, numbers), "size", CLOCK_SIZES)
