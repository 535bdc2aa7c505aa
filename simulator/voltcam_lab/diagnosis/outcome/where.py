"""Where model and measurement disagree: every statistic, ranked."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import false_discovery_control, t

from ...statistics import COUNTS, FLOORS, LABELS, PARTS, Label, Values
from ..search.hypothesis import Hypothesis
from ..search.loop import Diagnosis
from ..search.robust import mean_huber
from ..search.spread import HELD_OUT, TwinSpread
from ..search.state import Search
from ..search.step import SearchStep
from .sizes import Z_90


@dataclass(frozen=True, eq=False)
class Ranked:
    """All statistics, (n,) each, over all parts of a recording; twice, before and after.

    measured, expected: counts as numbers, values as they are, of all parts together. z: how far apart, of the
    twins' spread; q: false discovery rate at which it would be reported (Benjamini and Hochberg 1995).
    difference, low, high: share of what is expected for counts, in its own unit for values; 90 %.
    """

    measured: Values
    expected: Values
    z: Values
    q: Values
    difference: Values
    low: Values
    high: Values

    def order(self) -> NDArray[np.int64]:
        """By |z|, largest first."""
        return np.argsort(-np.abs(self.z), kind="stable")


@dataclass(frozen=True, eq=False)
class View:
    """A hypothesis beside the data. expected: (PARTS, n) what it gives on average; held_out: its gap there.
    model_error: what it is off by, as a share of each statistic. huber_z: of the gap."""

    hypothesis: Hypothesis
    spread: TwinSpread
    expected: Values
    held_out: float
    floor: float
    model_error: float
    huber_z: float


def views(search: Search, diagnosis: Diagnosis) -> dict[str, View]:
    """The fitted camera file "before" and the model "after", or, where nothing was added, the "model"."""
    first, last = (_view(search, diagnosis.steps[k]) for k in (0, -1))
    if diagnosis.residual is not None:
        hypothesis, held_out = diagnosis.residual.hypothesis, diagnosis.residual.trial.held_out
        expected = search.rig.means([hypothesis.parameters()], search.settings.runs.fitting)[0]
        last = replace(last, hypothesis=hypothesis, expected=expected, held_out=held_out)
    if first.hypothesis is last.hypothesis:
        return {"model": first}
    return {"before": first, "after": last}


def _view(search: Search, step: SearchStep) -> View:
    share, huber_z = search.settings.model_error.statistic_share, search.settings.huber_z
    expected = fitted_mean(step, search.data)
    gap, floor = step.held_out, step.floor_held_out
    return View(step.hypothesis, step.screen.spread, expected, gap, floor, share, huber_z)


def fitted_mean(step: SearchStep, data: Values) -> Values:
    """(PARTS, n) what the model of a step gives on average, its own parameters moved to fit best."""
    screen = step.screen
    own = screen.own(screen.flat((data - screen.spread.mean) / screen.spread.inflated_sd))
    moved: Values = screen.spread.mean + screen.spread.inflated_sd * (screen.base @ own.x)
    return moved


def ranked(view: View, data: Values) -> Ranked:
    """The statistics of data against a model."""
    twins = np.mean(view.spread.twins, axis=1)  # over the parts
    expected, measured = view.expected.mean(axis=0), data.mean(axis=0)
    sd = np.maximum(twins.std(axis=0, ddof=1), FLOORS / np.sqrt(PARTS))
    spread = np.sqrt(sd**2 * (1 + 1 / len(twins)) + (view.model_error * expected) ** 2)
    z = (measured - expected) / spread
    q = false_discovery_control(2 * t.sf(np.abs(z), len(twins) - 1))
    low, middle, high = (_difference(measured + k * Z_90 * spread, expected) for k in (-1, 0, 1))
    ours, theirs = (numbers(values).sum(axis=0) for values in (data, view.expected))
    return Ranked(ours, theirs, z, q, middle, low, high)


def gaps_by_group(view: View, data: Values) -> dict[str, tuple[float, float]]:
    """Of each group of statistics, by letter, the held-out gap and what chance alone leaves."""
    z = ((data - view.expected) / view.spread.sd)[list(HELD_OUT)]
    twins = [one[list(HELD_OUT)] for one in view.spread.left_out]
    found = {}
    for letter in dict.fromkeys(label.group for label in LABELS):
        mine = [label.group == letter for label in LABELS]
        found[letter] = (
            mean_huber(z[..., mine], view.huber_z),
            float(np.mean([mean_huber(twin[..., mine], view.huber_z) for twin in twins])),
        )
    return found


def label_in_words(label: Label) -> str:
    """A statistic in words."""
    which = ", ".join(f"{value}" if key in _SAID else f"{key} {value}" for key, value in label.strata)
    return f"{label.name}: {which}" if which else label.name


_SAID = ("polarity", "motion", "slope", "pair", "kinds", "kind", "speed", "lines", "neighbour")
"""Strata whose classes need no word before them."""


def numbers(values: Values) -> Values:
    """Comparable values as counts again; (..., n)."""
    counts = np.maximum((values / 2) ** 2 - 0.375, 0)
    return np.where(COUNTS, counts, values)


def _difference(measured: Values, expected: Values) -> Values:
    measured, expected = numbers(np.maximum(measured, np.where(COUNTS, 0, -np.inf))), numbers(expected)
    return np.where(COUNTS, (measured - expected) / np.maximum(expected, 0.5), PARTS * (measured - expected))
