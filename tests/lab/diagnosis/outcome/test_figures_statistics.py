"""Figures of statistics: each shows the numbers that it was given."""

import numpy as np
import pytest
from matplotlib.patches import StepPatch
from tests.lab.statistics.streams import still

from voltcam_lab.diagnosis.outcome.figures_statistics import (
    cells,
    deviation_dots,
    gap_bars,
    group_gap_bars,
    inter_event_histograms,
    lag_response_curves,
    rate_maps,
)
from voltcam_lab.diagnosis.outcome.where import Ranked
from voltcam_lab.statistics import LABELS
from voltcam_lab.statistics.strata import INTENSITY_NAMES, SLOPE_NAMES

N = len(LABELS)
SERIES = {
    name: np.random.default_rng(seed).integers(10, 500, N).astype(float)
    for seed, name in enumerate(("measured", "before", "after"))
}


def test_cells_are_the_places_of_the_table() -> None:
    index = cells("A", "events", "polarity", "intensity", "slope")
    assert index.shape == (2, len(INTENSITY_NAMES), len(SLOPE_NAMES))
    for (p, i, s), number in np.ndenumerate(index):
        label = LABELS[number]
        assert (label.group, label.name) == ("A", "events")
        assert [which for _, which in label.strata] == [("OFF", "ON")[p], INTENSITY_NAMES[i], SLOPE_NAMES[s]]
    assert len(np.unique(index)) == index.size


def test_bars_are_as_long_as_the_gaps_and_floors_stand_beside() -> None:
    (axes,) = gap_bars({"before": (4.5, 0.5), "after": (0.6, 0.4)}).get_axes()
    assert [bar.get_width() for bar in axes.patches] == [4.5, 0.6]
    assert [line.get_xdata()[0] for line in axes.lines] == [0.5, 0.4]
    assert [text.get_text() for text in axes.texts] == ["4.50", "0.60"]


def test_each_group_has_a_bar_of_each_model() -> None:
    gaps = {
        name: {letter: (k + 1.0, 0.5) for k, letter in enumerate("ABCDEFGHIJKL")}
        for name in ("before", "after")
    }
    (axes,) = group_gap_bars(gaps).get_axes()
    assert [bar.get_height() for bar in axes.patches] == 2 * [k + 1.0 for k in range(12)]
    assert len(axes.get_xticklabels()) == 12


def test_every_statistic_has_a_dot_at_its_z() -> None:
    none = np.zeros(N)
    z = np.random.default_rng(4).normal(0, 5, N)
    figure = deviation_dots({"before": Ranked(none, none, z, none, none, none, none)})
    (axes,) = figure.get_axes()
    _, dots = axes.collections
    assert np.asarray(dots.get_offsets())[:, 1] == pytest.approx(z)
    assert len(np.unique(np.asarray(dots.get_offsets())[:, 0])) == N


def test_maps_have_rates_and_shares_of_the_measured() -> None:
    setting = still(0.5)
    panels = rate_maps(SERIES, setting).get_axes()[:6]
    on = cells("A", "events", "polarity", "intensity", "slope")[1]
    shares = (SERIES["before"][on] + 0.5) / (SERIES["measured"][on] + 0.5)
    assert [text.get_text() for text in panels[1].texts] == [f"{share:.2g}" for share in shares.ravel()]
    rates = SERIES["measured"][on] / np.maximum(setting.seconds.sum(axis=0), 1e-9)
    assert [text.get_text() for text in panels[0].texts] == [f"{rate:.2g}" for rate in rates.ravel()]
    assert np.asarray(panels[1].images[0].get_array()) == pytest.approx(np.log2(shares))


def test_of_few_events_no_share_is_shown() -> None:
    few = {name: np.where(values < 250, 1.0, values) for name, values in SERIES.items()}
    panel = rate_maps(few, still(0.5)).get_axes()[1]
    on = cells("A", "events", "polarity", "intensity", "slope")[1]
    shown = [bool(text.get_text()) for text in panel.texts]
    assert shown == (few["measured"][on] + few["before"][on] >= 8).ravel().tolist()
    assert not all(shown)


def test_intervals_are_drawn_as_they_were_counted() -> None:
    figure = inter_event_histograms(SERIES)
    fine, coarse = (
        cells("B", "intervals, moving", "polarity", "interval"),
        cells("B", "intervals", "pair", "interval"),
    )
    wanted = [fine[1], fine[0], *coarse[:4]]
    panels = figure.get_axes()
    assert len(panels) == len(wanted)
    for panel, index in zip(panels, wanted, strict=True):
        drawn = [patch.get_data().values for patch in panel.patches if isinstance(patch, StepPatch)]
        assert [values.tolist() for values in drawn] == [each[index].tolist() for each in SERIES.values()]


def test_lag_curves_are_changes_per_event() -> None:
    panels = lag_response_curves(SERIES).get_axes()
    index = cells("H", "change before events", "intensity", "lag")
    rates = cells("A", "events", "polarity", "intensity", "slope")
    for k, panel in enumerate(panels):
        per_event = SERIES["after"][index[k]] / SERIES["after"][rates[:, k]].sum()
        assert any(
            np.allclose(line.get_ydata(), per_event) for line in panel.lines if len(line.get_ydata()) > 2
        )
        bars = [bar.get_height() for bar in panel.patches]
        assert bars == pytest.approx(SERIES["measured"][index[k]] / SERIES["measured"][rates[:, k]].sum())
