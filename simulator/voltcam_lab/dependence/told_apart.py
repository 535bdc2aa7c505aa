"""By what, and how well, can real events be told from simulated ones? In nats an event, held out in time."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator.effect import Events

from .additive import Additive, Array, Bins, fit, gain
from .covariates import LIGHT, Covariate, Look

FOLDS = 5
BLOCK_US = 100_000
MOST_EVENTS = 60_000  # of each kind: enough for thousandths of a nat
FEWEST = 200  # events of either kind, else nothing is said
STEPS = 4
SEED = 5

Chosen = Callable[[Events], NDArray[np.bool_]]


@dataclass(frozen=True, eq=False)
class Telling:
    """A covariate that was added; gain: what it added [nats an event], held out; function: (2, size) log
    ratio of real to simulated in each bin, OFF then ON; share: (2, size) of the real events in it."""

    covariate: Covariate
    gain: float
    function: NDArray[np.float64]
    share: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ToldApart:
    """light: nats an event that the light alone tells. alone: what each covariate tells beyond it, by name.
    steps: the best ones, each beside those before. events: (real, simulated) that were looked at."""

    light: float
    alone: Mapping[str, float]
    steps: tuple[Telling, ...]
    events: tuple[int, int]

    @property
    def total(self) -> float:
        """Nats an event by which real events are told from simulated ones: 0: nobody can; NaN: too few."""
        return (
            self.light if np.isnan(self.light) else max(self.light, 0.0) + sum(one.gain for one in self.steps)
        )


@dataclass(frozen=True, eq=False)
class _Table:
    bins: Mapping[str, Bins]
    real: NDArray[np.bool_]
    fold: NDArray[np.int64]

    def of(self, covariates: Sequence[Covariate], rows: NDArray[np.bool_]) -> list[Bins]:
        return [self.bins[each.name][rows] for each in covariates]


def told_apart(
    real: Events, simulated: Sequence[Events], look: Look, chosen: Chosen, steps: int = STEPS
) -> ToldApart:
    """Greedy: the light first, then `steps` times the covariate that tells most beside those before.

    simulated: one run or more, together. chosen: which events of a stream are judged; all of them are
    somebody's past.
    """
    table = _table(real, simulated, look, chosen)
    counts = int(np.count_nonzero(table.real)), int(np.count_nonzero(~table.real))
    if min(counts) < FEWEST:
        return ToldApart(float("nan"), {}, (), counts)
    known = [LIGHT]
    models = [_fitted(table, known, table.fold != fold) for fold in range(FOLDS)]
    told = light = _held_out(table, known, models)
    alone: dict[str, float] = {}
    found: list[Telling] = []
    for _ in range(steps):
        gains = {
            each.name: _held_out(table, [*known, each], _extended(table, known, models, each)) - told
            for each in look.covariates
            if each not in known
        }
        alone = alone or gains
        best = max(look.covariates, key=lambda each: gains.get(each.name, -np.inf))
        known.append(best)
        models = [_fitted(table, known, table.fold != fold) for fold in range(FOLDS)]
        gained = _held_out(table, known, models) - told
        if gained <= 0:
            break
        told += gained
        found.append(_step(table, known, gained))
    return ToldApart(light, alone, tuple(found), counts)


def told_by(
    real: Events, simulated: Sequence[Events], look: Look, chosen: Chosen, covariates: Sequence[Covariate]
) -> float:
    """Nats an event that light and these covariates together tell, of the events that the functions were
    fitted to: for comparing simulations with each other. NaN: too few events."""
    table = _table(real, simulated, look, chosen)
    if min(np.count_nonzero(table.real), np.count_nonzero(~table.real)) < FEWEST:
        return float("nan")
    known, rows = [LIGHT, *covariates], np.ones(len(table.real), bool)
    ratio = _fitted(table, known, rows).log_ratio(table.of(known, rows), len(rows))
    return gain(ratio, table.real)


def _table(real: Events, simulated: Sequence[Events], look: Look, chosen: Chosen) -> _Table:
    random = np.random.default_rng(SEED)
    most = [MOST_EVENTS, *[MOST_EVENTS // len(simulated)] * len(simulated)]
    picked, folds = [], []
    for events, limit in zip((real, *simulated), most, strict=True):
        rows = np.flatnonzero(chosen(events))
        if rows.size > limit:
            rows = np.sort(random.choice(rows, limit, replace=False))
        picked.append({name: bins[rows] for name, bins in look.bins(events).items()})
        folds.append(events["t"][rows] // BLOCK_US % FOLDS)
    bins = {name: np.concatenate([part[name] for part in picked]) for name in picked[0]}
    label = np.zeros(sum(map(len, folds)), bool)
    label[: len(folds[0])] = True
    return _Table(bins, label, np.concatenate(folds))


def _fitted(table: _Table, covariates: Sequence[Covariate], rows: NDArray[np.bool_]) -> Additive:
    sizes = [2 * each.size for each in covariates]
    return fit(table.of(covariates, rows), sizes, table.real[rows])


def _extended(
    table: _Table, known: Sequence[Covariate], models: Sequence[Additive], further: Covariate
) -> list[Additive]:
    """Each fold's model with one function more; those it has stay as they are, which is quick."""
    longer = []
    for fold, model in enumerate(models):
        rows = table.fold != fold
        ratio = model.log_ratio(table.of(known, rows), int(rows.sum()))
        added = fit(table.of([further], rows), [2 * further.size], table.real[rows], ratio)
        longer.append(model.and_then(added))
    return longer


def _held_out(table: _Table, covariates: Sequence[Covariate], models: Sequence[Additive]) -> float:
    """Gain at blocks of time that had no part in the fit of their fold's model."""
    ratio: Array = np.zeros(len(table.real))
    for fold, model in enumerate(models):
        test = table.fold == fold
        ratio[test] = model.log_ratio(table.of(covariates, test), int(test.sum()))
    return gain(ratio, table.real)


def _step(table: _Table, known: Sequence[Covariate], gained: float) -> Telling:
    """Of the last one of those known, fitted on everything."""
    last = known[-1]
    function = _fitted(table, known, np.ones(len(table.real), bool)).functions[-1]
    counts = np.bincount(table.bins[last.name][table.real], minlength=2 * last.size)
    share = counts / max(counts.sum(), 1)
    return Telling(last, gained, function.reshape(2, -1), share.reshape(2, -1))
