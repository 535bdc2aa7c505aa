"""Vignetting: everything that goes with brightness falls off from the centre, evenly all round."""

import numpy as np
import pytest

from voltcam_simulator import Simulator

from ..scenes import only, watch_still


@pytest.mark.parametrize(("width", "height"), [(61, 41), (200, 200), (1, 31), (1, 1)])
def test_leak_by_light_is_that_of_the_fourth_power_of_the_cosine(width: int, height: int) -> None:
    parameters = only(parasitic_photocurrent={"k5_per_dn_us": 1e-5}, vignetting={"corner_loss": 0.4})
    events = watch_still(Simulator(width, height, parameters, seed=1), 100, 0.5, 4)
    counts = np.zeros((height, width))
    np.add.at(counts, (events["y"], events["x"]), 1)
    y, x = np.mgrid[0:height, 0:width]
    r2 = (x - (width - 1) / 2) ** 2 + (y - (height - 1) / 2) ** 2
    angle = np.arctan(np.sqrt(r2 / max(r2.max(), 1) * (0.6**-0.5 - 1)))
    np.testing.assert_allclose(counts, 500 * np.cos(angle) ** 4, atol=1.1)
    if width > 1:
        assert counts[0, 0] == pytest.approx(0.6 * 500, abs=1.1)
