"""Patches of events that a classifier is to tell apart."""

import numpy as np
import pytest
from tests.lab.distances.made import END_US, HEIGHT, WHOLE, WIDTH, poisson, stream

from voltcam_lab.distances import patches as patch_measures
from voltcam_lab.distances.patches import FEWEST_EVENTS, LAG_EDGES, patches


def test_patches_of_another_law_are_told_apart_the_same_each_time() -> None:
    """As many events, but in bursts of two 300 us apart."""
    real, other = poisson(21), poisson(22, rate_hz=20)
    again = other.copy()
    again["t"] = np.minimum(again["t"] + 300, END_US - 1)
    bursts = np.sort(np.concatenate([other, again]), order="t")
    found = patch_measures.auc(real, bursts, WHOLE)
    assert found > 0.95
    assert patch_measures.auc(real, bursts, WHOLE) == found
    assert abs(patch_measures.auc(real, poisson(23), WHOLE) - 0.5) < 0.15


def test_features_are_shares_of_lags_and_steps() -> None:
    """13 events of one patch along a row, every 1000 us one pixel on, ON; then another patch with too few."""
    n = FEWEST_EVENTS + 1
    t, x = np.arange(n) * 1000, np.arange(n) % 12
    x[-1] = 0  # the same pixel as the first, 12 ms later
    events = stream(np.append(t, 500), np.append(x, 40), np.append(np.full(n, 3), 40), np.ones(n + 1, bool))
    found = patches(events, WHOLE)
    assert found.features.shape[0] == 1
    assert found.place.tolist() == [0]
    (row,) = found.features
    bins = len(LAG_EDGES) - 1
    lags = row[: 4 * bins].reshape(4, bins)
    assert (lags[:3] == -1).all()  # no OFF: nothing to share
    assert np.flatnonzero(lags[3]).tolist() == [np.searchsorted(LAG_EDGES, np.log10(12_000)) - 1]
    steps, rows, stamps, soon, *of_sensor = np.split(row[4 * bins :], [6, 8, 10, 12, 14, 16])
    assert steps == pytest.approx([0, 11 / 12, 0, 0, 0, 1 / 12])  # one pixel on, and once 11 back
    assert rows.tolist() == [0, 1]
    assert stamps.tolist() == soon.tolist() == [1, 0]
    assert [share.tolist() for share in of_sensor] == [[1, 0]] * 3


def test_what_the_sensor_does_at_one_time_is_seen_in_each_patch() -> None:
    """Two patches of one row, event for event at one time: within either, no time comes twice."""
    n = 2 * FEWEST_EVENTS
    t, x = np.repeat(np.arange(n) * 1000, 2), np.tile([0, 30], n)
    found = patches(stream(t, x, np.full(2 * n, 3), np.ones(2 * n, bool)), WHOLE)
    assert found.features.shape[0] == 2
    for features, second in zip(found.features, (0, 1), strict=True):
        assert features[-10:-6].tolist() == [1, 0, 1, 0]
        assert features[-6:].reshape(3, 2)[:, 1].tolist() == [second] * 3


def test_places_that_lie_together_are_of_one_fold() -> None:
    """2 x 2 patches are one place."""
    events = poisson(6)
    found = patches(events, WHOLE)
    columns = WIDTH // 12
    row, column = np.divmod(found.cell % (columns * HEIGHT // 12), columns)
    pairs = set(zip(found.place.tolist(), (row // 2).tolist(), (column // 2).tolist(), strict=True))
    assert len(pairs) == len({place for place, *_ in pairs}) == 3 * 3  # 6 x 5 patches
