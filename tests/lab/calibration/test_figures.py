"""Parameters with their intervals, drawn as they are."""

import numpy as np
import pytest

from voltcam_lab.calibration.estimates import Estimate
from voltcam_lab.calibration.figures import UNSURE, parameter_intervals
from voltcam_lab.pages.style import BLUE

SURE = Estimate("contrast_response", "k1", 5.0, 4.0, 6.0, (1.0, 25.0), 0.9)
OPEN = Estimate("photon_noise", "k3", 1e-4, 1e-5, 1e-3, (2e-5, 5e-4), 0.1)


def test_each_parameter_has_a_panel_with_its_interval_and_its_value() -> None:
    panels = parameter_intervals([SURE, OPEN]).get_axes()
    assert [panel.get_visible() for panel in panels] == [True, True, False]
    for panel, one, colour in zip(panels, (SURE, OPEN), (BLUE, UNSURE), strict=False):
        interval, dot = panel.lines
        assert interval.get_xdata() == pytest.approx([one.low, one.high])
        assert np.ravel(dot.get_xdata()) == pytest.approx([one.value])
        assert {interval.get_color(), dot.get_color()} == {colour}
        assert panel.get_title("left") == f"{one.effect}.{one.parameter}"
        low, high = panel.get_xlim()
        assert low < min(one.low, one.usual[0]) < max(one.high, one.usual[1]) < high


def test_what_is_nothing_is_an_arrow_at_the_edge_of_a_logarithmic_panel() -> None:
    none = Estimate("leak_noise", "k6", 0.0, 0.0, 4e-5, (1e-6, 1e-4), 0.1)
    panel = parameter_intervals([none]).get_axes()[0]
    interval, dot = panel.lines
    edge, _ = panel.get_xlim()
    assert edge == pytest.approx(1e-6 / 1.5)
    assert interval.get_xdata() == pytest.approx([edge, 4e-5])
    assert (dot.get_marker(), *np.ravel(dot.get_xdata())) == ("<", pytest.approx(edge))


def test_panels_fill_rows_of_three() -> None:
    visible = [panel.get_visible() for panel in parameter_intervals([SURE] * 7).get_axes()]
    assert visible == [True] * 7 + [False] * 2
