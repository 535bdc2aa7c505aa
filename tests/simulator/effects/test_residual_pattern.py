"""A wave over the pixels: where it has its crest, thresholds are higher and events fewer."""

import numpy as np
import pytest

from voltcam_simulator import Parameters, Simulator

from ..scenes import only, still

WIDTH, HEIGHT = 40, 24
SWING = 100 * np.log(220 / 30)  # thresholds from 10 to 200 DN


def counts(**pattern: float) -> tuple[np.ndarray, np.ndarray]:
    """(height, width) of ON and OFF events in a cycle from 10 to 200 DN and back."""
    parameters: Parameters = only(contrast_response={"k1": 100}, residual_pattern=pattern)
    simulator = Simulator(WIDTH, HEIGHT, parameters, seed=3)
    simulator.advance(still(10, WIDTH, HEIGHT), 0)
    found = []
    for grey, t_us in ((200, 100_000), (10, 200_000)):
        events = simulator.advance(still(grey, WIDTH, HEIGHT), t_us)
        counted = np.zeros((HEIGHT, WIDTH), int)
        np.add.at(counted, (events["y"], events["x"]), 1)
        found.append(counted)
    return found[0], found[1]


def test_counts_are_the_swing_over_the_threshold_of_the_pixel() -> None:
    """To one event, and to where the voltage started: up to 1.2/0.7 ON thresholds lower."""
    on, off = counts(on=0.3, off=-0.2, across_per_px=0.1, down_per_px=-0.05, crest_turns=0.2)
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    wave = np.cos(2 * np.pi * (0.1 * x - 0.05 * y - 0.2))
    assert np.abs(on - SWING / (1 + 0.3 * wave)).max() <= 1 + 1.2 / 0.7
    assert np.abs(off - SWING / (1 - 0.2 * wave)).max() <= 1 + 1.3 / 0.8


@pytest.mark.parametrize(("across", "down"), [(0.5, 0.0), (0.0, 0.5), (0.5, 0.5)])
def test_two_pixels_a_wave_are_columns_rows_or_a_chequerboard_that_take_turns(
    across: float, down: float
) -> None:
    on, _ = counts(on=0.2, across_per_px=across, down_per_px=down)
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    odd = (2 * across * x + 2 * down * y).astype(int) % 2 == 1
    assert on[odd].min() > 1.3 * on[~odd].max()  # 1.2/0.8 is 1.5


def test_a_pattern_of_no_size_is_none() -> None:
    on, off = counts(across_per_px=0.25)
    plain_on, plain_off = counts()
    assert (on == plain_on).all()
    assert (off == plain_off).all()
