"""Where model and measurement disagree: every statistic of the battery, ranked."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import false_discovery_control, t

from ...statistics import COUNTS, FLOORS, LABELS, PARTS, Label
from ..rig.rig import Rig, Values
from ..search.loop import Diagnosis
from ..search.model import FLOOR_SHARE, HELD_OUT, Model, Spread, flat
from ..search.robust import gap
from ..search.step import Step
from ..search.trial import FITTING

Vector = NDArray[np.float64]
_90 = 1.645


@dataclass(frozen=True, eq=False)
class Ranked:
    """All statistics of the battery, (n,) each, over all parts of a recording; twice, before and after.

    measured, expected: counts as numbers, values as they are, of all parts together. z: how far apart, of the
    twins' spread; q: false discovery rate at which it would be reported (Benjamini and Hochberg 1995).
    difference, low, high: share of what is expected for counts, in its own unit for values; 90 %.
    """

    measured: Vector
    expected: Vector
    z: Vector
    q: Vector
    difference: Vector
    low: Vector
    high: Vector

    def order(self) -> NDArray[np.int64]:
        """By |z|, largest first."""
        return np.argsort(-np.abs(self.z), kind="stable")


@dataclass(frozen=True, eq=False)
class View:
    """A model beside the data. expected: (PARTS, n) what it gives on average; held_out: its gap there."""

    model: Model
    spread: Spread
    expected: Values
    held_out: float
    floor: float


def views(rig: Rig, diagnosis: Diagnosis, data: Values) -> dict[str, View]:
    """The fitted camera file "before" and the model "after", or, where nothing was added, the "model"."""
    first, last = (_view(diagnosis.steps[k], data) for k in (0, -1))
    if diagnosis.residual is not None:
        model = diagnosis.residual.model
        expected = rig.means([model.parameters()], FITTING)[0]
        last = View(model, last.spread, expected, diagnosis.residual.trial.held_out, last.floor)
    if first.model is last.model:
        return {"model": first}
    return {"before": first, "after": last}


def _view(step: Step, data: Values) -> View:
    expected = fitted_mean(step, data)
    return View(step.model, step.screen.spread, expected, step.held_out, step.floor_held_out)


def fitted_mean(step: Step, data: Values) -> Values:
    """(PARTS, n) what the model of a step gives on average, its own parameters moved to fit best."""
    screen = step.screen
    own = screen.own(flat((data - screen.spread.mean) / screen.spread.lenient))
    moved: Values = screen.spread.mean + screen.spread.lenient * (screen.base @ own.x)
    return moved


def ranked(view: View, data: Values) -> Ranked:
    """The statistics of data against a model."""
    twins = np.mean(view.spread.twins, axis=1)  # over the parts
    expected, measured = view.expected.mean(axis=0), data.mean(axis=0)
    sd = np.maximum(twins.std(axis=0, ddof=1), FLOORS / np.sqrt(PARTS))
    v = np.sqrt(sd**2 * (1 + 1 / len(twins)) + (FLOOR_SHARE * expected) ** 2)
    z = (measured - expected) / v
    q = false_discovery_control(2 * t.sf(np.abs(z), len(twins) - 1))
    low, middle, high = (_difference(measured + k * _90 * v, expected) for k in (-1, 0, 1))
    seen, told = (numbers(values).sum(axis=0) for values in (data, view.expected))
    return Ranked(seen, told, z, q, middle, low, high)


def gap_by_group(view: View, data: Values) -> dict[str, tuple[float, float]]:
    """Of each of the battery's groups, by letter, the held-out gap and what chance alone leaves."""
    z = ((data - view.expected) / view.spread.v)[list(HELD_OUT)]
    twins = [one[list(HELD_OUT)] for one in view.spread.left_out]
    found = {}
    for letter in dict.fromkeys(label.group for label in LABELS):
        mine = [label.group == letter for label in LABELS]
        found[letter] = gap(z[..., mine]), float(np.mean([gap(twin[..., mine]) for twin in twins]))
    return found


def plain(label: Label) -> str:
    """A statistic in words."""
    which = ", ".join(f"{value}" if key in _SAID else f"{key} {value}" for key, value in label.strata)
    return f"{label.name}: {which}" if which else label.name


_SAID = ("polarity", "motion", "slope", "pair", "kinds", "kind", "speed", "lines", "neighbour")
"""Strata whose classes need no word before them."""


def numbers(values: Values) -> Values:
    """Comparable values as counts again; (..., n)."""
    counts = np.maximum((values / 2) ** 2 - 0.375, 0)
    return np.where(COUNTS, counts, values)


def _difference(measured: Vector, expected: Vector) -> Vector:
    measured, expected = numbers(np.maximum(measured, np.where(COUNTS, 0, -np.inf))), numbers(expected)
    return np.where(COUNTS, (measured - expected) / np.maximum(expected, 0.5), PARTS * (measured - expected))
