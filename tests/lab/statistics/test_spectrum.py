"""Group E: periods in the light.

Bounds are 4.5 standard deviations or more wide: another seed would fail once in 100 000 times.
"""

import numpy as np
import pytest

from voltcam_lab.statistics import Setting
from voltcam_lab.statistics.spectrum import SCAN_HZ, SPECTRUM_BIN_US, scan

from .streams import poisson, seen, still

SECONDS = 8.0


@pytest.fixture(scope="module")
def rest() -> Setting:
    return still(SECONDS)


def test_flicker_stands_in_its_band(rest: Setting) -> None:
    rng, depth = np.random.default_rng(6), 0.5
    events = np.concatenate([poisson(rng, 10.0, on=True), poisson(rng, 10.0, on=False)])
    turn = np.where(events["p"], 1, -1) * np.sin(2 * np.pi * 100.03 * events["t"] * 1e-6)
    kept = events[rng.random(len(events)) < (1 + depth * turn) / (1 + depth)]
    amplitude = seen(rest, kept, "E", "largest amplitude of ON - OFF", "95 to 105 Hz", "rest")[0]
    beside = seen(rest, kept, "E", "largest amplitude of ON - OFF", "125 to 200 Hz", "rest")[0]
    expected = 4 * depth / 2 * np.sqrt(len(kept) / 4)  # each of four parts
    assert 0.85 * expected < amplitude < 1.02 * expected  # a tenth is lost between two frequencies
    assert beside < 4 * np.sqrt(np.log(150 * 8 * 1e6))  # largest of some 1200 exponential powers


@pytest.mark.parametrize("hz", [30.3, 50.1, 60.0, 99.6, 250.2])
def test_the_largest_amplitude_of_a_band_is_that_of_a_direct_sum(hz: float) -> None:
    """Against the Fourier sum at 0.01 Hz steps, which the transform's own steps can miss by a little."""
    t = np.arange(3000) * SPECTRUM_BIN_US * 1e-6
    series = np.random.default_rng(18).normal(0, 1, t.size) + np.sin(2 * np.pi * hz * t)
    band = int(np.searchsorted(SCAN_HZ, hz)) - 1
    fine = np.arange(hz - 1, hz + 1, 0.01)
    direct = np.abs(np.exp(-2j * np.pi * fine[:, None] * t) @ series).max()
    found = scan(series)
    assert found.argmax() == band
    assert 0.9 * direct < found[band] <= direct * (1 + 1e-9)
