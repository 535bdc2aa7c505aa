"""Crosstalk by its signature: neighbours fire together at rest."""

import math

import numpy as np
import pytest

from voltcam_simulator import Simulator

from ..scenes import Events, intervals_us, only, watch_still

SIDE, PIXELS, SECONDS = 250, 62_500, 0.5
LEAK = {"k4_per_us": 1e-6}


def at_rest(fps: float = 20, **changes: object) -> Events:
    return watch_still(Simulator(SIDE, SIDE, only(**changes), seed=8), 100, SECONDS, fps)


def together(events: Events) -> int:
    """Events right after one of a neighbour, in the same microsecond."""
    near = np.abs(np.diff(events["x"].astype(int))) + np.abs(np.diff(events["y"].astype(int))) == 1
    return int((near & (np.diff(events["t"]) == 0)).sum())


@pytest.mark.parametrize(("coupling", "fps"), [(0.01, 20), (0.03, 20), (0.03, 200)])
def test_neighbours_fire_together(coupling: float, fps: float) -> None:
    events = at_rest(fps, junction_leak=LEAK, crosstalk={"coupling": coupling})
    # voltages are uniform on (0, 1), so each of an event's neighbours is within reach with chance `coupling`;
    # half a period only: those that have fired together stay together, with no noise to part them
    neighbours = 4 * (1 - 1 / SIDE)
    expected = neighbours * coupling / (1 + neighbours * coupling)
    share = together(events) / len(events)
    # 5 standard deviations, and the second order in the coupling
    assert share == pytest.approx(expected, abs=5 * math.sqrt(expected / len(events)) + expected * coupling)
    assert events["p"].all()
    # the mean voltage an event costs is 1: leak and kicks pay for it
    rate = len(events) / PIXELS / SECONDS
    assert rate == pytest.approx(1 + expected * rate, rel=0.02)


def test_without_it_they_do_so_by_chance_only() -> None:
    events = at_rest(junction_leak=LEAK)
    assert together(events) < 5  # two neighbours in one microsecond: expected 0.35


def test_both_polarities_couple_with_their_sign() -> None:
    noise = {"k6": 1e-3}
    events = at_rest(leak_noise=noise, crosstalk={"coupling": 0.05})
    near = np.abs(np.diff(events["x"].astype(int))) + np.abs(np.diff(events["y"].astype(int))) == 1
    pairs = np.flatnonzero(near & (np.diff(events["t"]) == 0))
    assert len(pairs) > 100
    alike = events["p"][pairs] == events["p"][pairs + 1]
    assert alike.mean() > 0.95
    assert 0.4 < events["p"][pairs].mean() < 0.6


def test_corner_and_single_pixels_have_no_more_neighbours_than_they_have() -> None:
    for width, height in ((1, 1), (1, 7), (7, 1), (2, 2)):
        parameters = only(junction_leak={"k4_per_us": 1e-4}, crosstalk={"coupling": 0.25})
        events = watch_still(Simulator(width, height, parameters, seed=1), 100, 1, 10)
        assert len(events) >= 100 * width * height * 0.99 - width * height
        assert events["x"].max() < width
        assert events["y"].max() < height
        assert (intervals_us(events, width) >= 0).all()


def test_dead_times_hold_for_events_set_off_and_after_them() -> None:
    dead = {"refractory_period": {"period_us": 2000}, "leak_noise": {"k6": 1e-2}}
    events = at_rest(crosstalk={"coupling": 0.1}, **dead)
    assert together(events) > 1000
    assert intervals_us(events, SIDE).min() >= 1999  # times are whole microseconds
