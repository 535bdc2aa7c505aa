"""Can a classifier tell patches of real events from simulated ones? Its area under the curve (AUC)."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.ensemble import HistGradientBoostingClassifier
from sklearn.metrics import roc_auc_score
from sklearn.model_selection import StratifiedGroupKFold
from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]

from voltcam_simulator.effect import Events

from .inter_event_intervals import any_polarity
from .region import Halves, Region

TILE_PIXELS = 12
SLICE_US = 100_000
FEWEST_EVENTS = 12
FOLDS = 5
LAG_EDGES = np.concatenate([[-np.inf], np.arange(2, 5.6, 0.5), [np.inf]])  # decades of us
SOON_US = 10  # what the bus does to events that come together
STEP_EDGES = np.array([0, 1, 2, 3, 5, 8, np.inf])  # pixels from an event of the patch to the next

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Patches:
    """cell: (N,) number of the 12 x 12 pixels and 100 ms, ascending; place: (N,) number of the 2 x 2 patches
    around, which go into one fold; features: (N, F), shares, -1 where there is nothing to share."""

    place: NDArray[np.int64]
    cell: NDArray[np.int64]
    features: Array


def patches(events: Events, region: Region) -> Patches:
    """The patches with events enough. Features are shares within the patch: of lags to the pixel's event
    before, for each pair of polarities; of steps from event to event; of events at one time or within 10 us,
    in the patch and with any event of the sensor or the row; never counts."""
    columns = -(-region.pixels.shape[1] // TILE_PIXELS)
    places = columns * -(-region.pixels.shape[0] // TILE_PIXELS)

    def cell_of(t_us: NDArray[np.int64], x: NDArray[np.uint16], y: NDArray[np.uint16]) -> NDArray[np.int64]:
        place = y.astype(np.int64) // TILE_PIXELS * columns + x // TILE_PIXELS
        cell: NDArray[np.int64] = t_us // SLICE_US * places + place
        return cell

    lags = any_polarity(events, region)
    events = region.of(events)
    cells, number, count = np.unique(
        cell_of(events["t"], events["x"], events["y"]), return_inverse=True, return_counts=True
    )
    lag_cell = cell_of(lags.t_us, lags.x, lags.y)
    known = np.isin(lag_cell, cells)  # a lag's middle may fall where no event is
    lags, lag_number = lags.where(known), np.searchsorted(cells, lag_cell[known])
    by_pair = [
        _shares(lag_number[lags.group == pair], lags.decades[lags.group == pair], LAG_EDGES, len(cells))
        for pair in range(4)
    ]
    together = _with_the_sensor(events, number, len(cells))
    features = np.hstack([*by_pair, *_steps(events, number, len(cells)), *together])
    enough = count >= FEWEST_EVENTS
    row, column = np.divmod(cells % places, columns)
    return Patches((row // 2 * columns + column // 2)[enough], cells[enough], features[enough])


def _steps(events: Events, number: NDArray[np.int64], cells: int) -> list[Array]:
    """From each event of a patch to the next: how far, along the row, at the same time."""
    order = np.argsort(number, kind="stable")
    events, number = events[order], number[order]
    same = number[1:] == number[:-1]
    x, y = events["x"].astype(np.int64), events["y"].astype(np.int64)
    dx, dy, dt = np.abs(np.diff(x))[same], np.abs(np.diff(y))[same], np.diff(events["t"])[same]
    number = number[1:][same]
    half = np.array([0, 0.5, 1.5])
    return [
        _shares(number, np.maximum(dx, dy).astype(np.float64), STEP_EDGES, cells),
        _shares(number, (dy == 0).astype(np.float64), half, cells),
        _shares(number, (dt == 0).astype(np.float64), half, cells),
        _shares(number, (dt <= SOON_US).astype(np.float64), half, cells),
    ]


def _with_the_sensor(events: Events, number: NDArray[np.int64], cells: int) -> list[Array]:
    """Of each event and the one before it in all of the sensor: one time, within 10 us, one time and row."""
    dt = np.diff(events["t"], prepend=np.iinfo(np.int64).min // 2)
    same_row = np.diff(events["y"].astype(np.int64), prepend=-1) == 0
    half = np.array([0, 0.5, 1.5])
    flags = (dt == 0, dt <= SOON_US, (dt == 0) & same_row)
    return [_shares(number, flag.astype(np.float64), half, cells) for flag in flags]


def _shares(row: NDArray[np.int64], values: Array, edges: Array, rows: int) -> Array:
    """(rows, bins): the histogram of each row's values, as shares."""
    bins = len(edges) - 1
    column = np.searchsorted(edges, values, side="right") - 1
    counts = np.bincount(row * bins + column, minlength=rows * bins).reshape(rows, bins)
    with np.errstate(invalid="ignore"):
        shares = counts / counts.sum(axis=1, keepdims=True)
    known: Array = np.nan_to_num(shares, nan=-1.0)
    return known


def auc(real: Events, simulated: Events, region: Region) -> float:
    """Over the patches that have events enough in both: 0.5 cannot be told apart, 1 always. NaN: too few."""
    first, second = patches(real, region), patches(simulated, region)
    _, one, other = np.intersect1d(first.cell, second.cell, assume_unique=True, return_indices=True)
    return _told_apart(_rows(first, one), _rows(second, other))


def auc_of_halves(real: Events, halves: Halves) -> float:
    """The same between real events here and there."""
    return _told_apart(*(patches(real, half) for half in halves))


def _rows(patches: Patches, rows: NDArray[np.intp]) -> Patches:
    return Patches(patches.place[rows], patches.cell[rows], patches.features[rows])


def _told_apart(first: Patches, second: Patches) -> float:
    """AUC at places that the classifier has not been trained on: the mean of the folds' own, since pooled
    predictions differ from fold to fold, which pulls the AUC of what is alike below 0.5."""
    label = np.repeat([0, 1], [len(first.cell), len(second.cell)])
    place = np.concatenate([first.place, second.place])
    if min(len(first.cell), len(second.cell)) < 2 * FOLDS or len(np.unique(place)) < FOLDS:
        return float("nan")
    features = np.concatenate([first.features, second.features])
    found = []
    with threadpool_limits(1):  # so small a job only waits for other threads, minutes on a busy machine
        for train, test in StratifiedGroupKFold(FOLDS).split(features, label, place):
            if len(np.unique(label[train])) == len(np.unique(label[test])) == 2:
                classifier = HistGradientBoostingClassifier(
                    max_iter=60,
                    early_stopping=False,  # pyright: ignore[reportArgumentType]
                    random_state=0,
                ).fit(features[train], label[train])
                told: Any = classifier.predict_proba(features[test])
                found.append(roc_auc_score(label[test], told[:, 1]))
    return float(np.mean(found)) if found else float("nan")
