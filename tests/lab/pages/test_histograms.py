"""Interval histograms: each panel has its own thirds."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
from matplotlib.patches import StepPatch
from tests.lab.pages.drawn import REGION, light, some_events, with_data

from voltcam_lab.distances.inter_event_intervals import IntervalStrata, same_polarity
from voltcam_lab.pages.histograms import EDGES, interval_histograms


def test_each_panel_has_the_shares_of_its_own_intervals() -> None:
    """Counted one by one; a share per decade, so that bins of a tenth add up to 1."""
    real, simulated = (same_polarity(some_events(seed), REGION) for seed in (1, 2))
    strata = IntervalStrata.of(real, light())
    figure = interval_histograms(real, {"exact": simulated}, strata)
    panels = figure.get_axes()
    assert len(panels) == 9
    assert with_data(figure) == 9 * 2
    for intervals, which in ((real, 0), (simulated, 1)):
        brightness, speed = strata.numbers(intervals)
        for number, panel in enumerate(panels):
            row, column = divmod(number, 3)
            mine = [
                decades
                for decades, b, s in zip(intervals.decades, brightness, speed, strict=True)
                if (b, s) == (row, column)
            ]
            (bars,) = [patch.get_data() for patch in panel.patches if isinstance(patch, StepPatch)][
                which : which + 1
            ]
            counted = [
                sum(low <= one < high for one in mine) / len(mine) * 10 for low, high in pairwise(EDGES)
            ]
            np.testing.assert_allclose(bars.values, counted)


def test_a_stream_without_intervals_is_drawn_flat() -> None:
    real = same_polarity(some_events(1), REGION)
    figure = interval_histograms(
        real, {"none": same_polarity(some_events(1)[:0], REGION)}, IntervalStrata.of(real, light())
    )
    assert with_data(figure) == 9


def test_a_model_with_all_in_one_place_does_not_flatten_the_others() -> None:
    real = same_polarity(some_events(1), REGION)
    strata = IntervalStrata.of(real, light())
    alike = replace(real, decades=np.full_like(real.decades, 4.0))
    shown = [interval_histograms(real, models, strata).get_axes() for models in ({}, {"regular": alike})]
    for alone, beside in zip(*shown, strict=True):
        (bars,) = [patch for patch in alone.patches if isinstance(patch, StepPatch)]
        highest = np.max(bars.get_data().values)
        assert beside.get_ylim() == alone.get_ylim()
        assert beside.get_ylim()[1] >= 2 * highest
