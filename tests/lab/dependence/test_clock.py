"""A clock is found by its period and by how its phase moves with the row; none is found where none is."""

import numpy as np
import pytest

from voltcam_lab.dependence.clock import clock_of
from voltcam_lab.dependence.told_apart import told_apart
from voltcam_lab.dependence.words import sentence

from .made import END_US, HEIGHT, everything, free, look


def clocked(seed: int, period_us: float, row_us: float, depth: float = 0.6) -> np.ndarray:
    """Events that are thinned at one side of a clock's period, in each row later."""
    events, rng = free(seed, 20_000), np.random.default_rng(seed + 1)
    turn = (events["t"] - row_us * events["y"]) / period_us
    return events[rng.random(len(events)) < (1 + depth * np.sin(2 * np.pi * turn)) / (1 + depth)]


@pytest.mark.parametrize(("period_us", "row_us"), [(7_770.0, 0.0), (1_234.5, 20.0), (52_000.0, -900.0)])
def test_a_clock_is_found_by_period_and_slope(period_us: float, row_us: float) -> None:
    real = clocked(3, period_us, row_us)
    clock = clock_of(real, [free(4), free(5)], HEIGHT)
    assert clock is not None
    # over the whole time it is right to a third of a turn, and over all rows
    assert abs(END_US / clock.period_us - END_US / period_us) < 0.15
    assert (HEIGHT - 1) * abs(clock.row_us - row_us) / period_us < 0.15
    found = told_apart(real, [free(4), free(5)], look(real).finer(clock), everything)
    first = found.steps[0]
    assert (first.covariate.name, first.covariate.kind) == ("clock", "clock")
    assert first.gain > 0.015
    assert "depends on a clock as" in sentence(first)
    assert f"{clock.period_us / 1000:.4g} ms" in sentence(first)


def test_it_is_said_how_often_a_clock_of_the_frames_ticks_from_one_to_the_next() -> None:
    frame_us = 23 * 1_234.5
    for off, said in ((1.0, ", 23 to a frame)"), (1 + 3 * 1_234.5 / END_US, " Hz)")):
        clock = clock_of(clocked(3, 1_234.5, 0.0), [free(4), free(5)], HEIGHT, frame_us * off)
        assert str(clock).endswith(said)


def test_chance_makes_no_clock() -> None:
    """A false line is expected in one of a thousand scans: of 20, one with a chance of .02."""
    assert sum(clock_of(free(k), [free(k + 100)], HEIGHT) is not None for k in range(20)) <= 1


def test_a_clock_that_the_simulated_events_have_too_is_none() -> None:
    real, same = clocked(3, 7_770.0, 0.0), clocked(6, 7_770.0, 0.0)
    assert clock_of(real, [same], HEIGHT) is None


def test_without_events_there_is_none() -> None:
    assert clock_of(free(1, 0), [free(2)], HEIGHT) is None
    assert clock_of(free(1), [], HEIGHT) is None
    assert clock_of(free(1, 2), [free(2)], HEIGHT) is None


def test_which_pixel_it_is_is_told_by_part_and_by_lattice() -> None:
    real = free(7, 20_000)
    rng = np.random.default_rng(8)
    odd = real[(real["x"] % 4 != 1) | (rng.random(len(real)) < 0.5)]
    corner = real[(real["x"] < 15) | (real["y"] < 12) | (rng.random(len(real)) < 0.4)]
    for events, name, words in (
        (odd, "lattice", "of each square of 4 x 4 pixels"),
        (corner, "patch", "of 8 across and 6 down"),
    ):
        found = told_apart(events, [free(9, len(events))], look(events).finer(None), everything)
        first = found.steps[0]
        assert (first.covariate.name, first.covariate.kind) == (name, "pixel")
        assert words in sentence(first)
        assert "which pixel it is" in sentence(first)
