"""A clock without a name: events lock to its phase, which moves with the row."""

import numpy as np
import pytest

from voltcam_simulator import Parameters

from ..scenes import Events, cuts, only, watch_at

WIDTH, HEIGHT = 30, 50
PERIOD_US, BEGIN_US = 7_000, 1234


def leaky(leak_per_us: float = 2e-6, row_us: float = -20.25, kick: float = 0.05) -> Parameters:
    """A leak of 0.014 thresholds in each period, without any noise."""
    clock = {"kick": kick, "period_us": PERIOD_US, "begin_us": BEGIN_US, "row_us": row_us}
    return only(junction_leak={"k4_per_us": leak_per_us}, residual_clock=clock)


def watch(parameters: Parameters, times_us: np.ndarray) -> Events:
    return watch_at(parameters, times_us, WIDTH, HEIGHT)


@pytest.mark.parametrize("row_us", [-20.25, 0.0, 33.0])
def test_events_of_a_leak_come_where_the_clock_goes_up_row_after_row(row_us: float) -> None:
    """A pixel that gains 0.014 in a period is caught by a kick of 0.05, or in the half period after it."""
    events = watch(leaky(row_us=row_us), cuts(50))
    events = events[events["t"] > 2 * PERIOD_US]  # some stood within reach before the first kick
    assert len(events) > 3 * WIDTH * HEIGHT
    phase_us = (events["t"] - BEGIN_US - np.floor(events["y"] * row_us)) % PERIOD_US
    assert np.isin(phase_us, [0, PERIOD_US - 1]).mean() == pytest.approx(0.5, abs=0.03)
    assert phase_us.min() >= 0
    assert np.count_nonzero((phase_us > PERIOD_US / 2 + 1) & (phase_us < PERIOD_US - 1)) == 0


@pytest.mark.parametrize("pieces", [2, 33, 5_000])
def test_every_kick_comes_once_however_time_is_cut(pieces: int) -> None:
    """Nothing is random but where voltages start: events are the same but for a microsecond of rounding."""
    whole, parts = (watch(leaky(), cuts(n)) for n in (1, pieces))
    key = lambda events: np.lexsort((events["t"], events["x"], events["y"]))  # noqa: E731
    whole, parts = whole[key(whole)], parts[key(parts)]
    assert len(whole) == len(parts) > 1000
    assert (whole["x"] == parts["x"]).all()
    assert np.abs(whole["t"] - parts["t"]).max() <= 2


def test_off_events_come_half_a_period_later() -> None:
    parameters = leaky().changed({"junction_leak": {"k4_per_us": 0.0}, "residual_drift": {"per_us": -2e-6}})
    events = watch(parameters, cuts(50))
    events = events[events["t"] > 2 * PERIOD_US]
    assert not events["p"].any()
    phase_us = (events["t"] - BEGIN_US - np.floor(events["y"] * -20.25)) % PERIOD_US
    assert np.abs(phase_us - PERIOD_US / 2).min() <= 1
    assert np.count_nonzero((phase_us > 1) & (phase_us < PERIOD_US / 2 - 1)) == 0
