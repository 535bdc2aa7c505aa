"""Maps of where a simulation has too many events."""

import numpy as np
import pytest
from tests.lab.pages.drawn import REGION, some_events, with_data

from voltcam_lab.distances.counts import count_images, watched
from voltcam_lab.pages.residuals import residual_maps


def test_maps_and_curves_are_logarithms_of_ratios_and_the_unwatched_is_blank() -> None:
    """Ten times the events in one cell, a tenth in all of one time; a column is not looked at."""
    real = np.full((4, 3, 5), 9)
    simulated = real.copy()
    simulated[:, 1, 2] = 90
    simulated[3] = 0
    watched = np.ones(real.shape, bool)
    watched[:, :, 4] = False
    figure = residual_maps(real, {"exact": simulated}, watched)
    over_sensor, over_time = figure.get_axes()[:2]
    image = np.ma.filled(over_sensor.images[0].get_array(), np.nan)
    assert np.isnan(image[:, 4]).all()
    assert image[0, 0] == pytest.approx(np.log10((27 + 1) / (36 + 1)))
    assert image[1, 2] == pytest.approx(np.log10((270 + 1) / (36 + 1)))
    (curve,) = [line.get_ydata() for line in over_time.lines if len(line.get_ydata()) == 4]
    assert curve[:3] == pytest.approx(np.log10((11 * 9 + 90) / (12 * 9)))
    assert np.isnan(curve[3])  # of no events there is no logarithm


def test_each_model_has_a_map_and_a_curve() -> None:
    images = [count_images(some_events(seed), REGION) for seed in (1, 2, 3)]
    figure = residual_maps(images[0], {"exact": images[1], "esim": images[2]}, watched(REGION))
    assert with_data(figure) == 2 * 2
    assert [axes.get_title("left") for axes in figure.get_axes()[:2]] == ["exact", "esim"]
