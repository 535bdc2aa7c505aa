"""A lamp, as events tell of it."""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_lab.diagnosis.catalogue.flicker import Lamp, LampSearch
from voltcam_simulator import Parameters

from ..made_rig import swaying

SEARCH = LampSearch()


@pytest.mark.parametrize("hz", [100.0, 120.0, 73.0])
def test_the_frequency_of_flickering_light(hz: float) -> None:
    rng = np.random.default_rng(1)
    t_us = np.sort(rng.uniform(0, 5e6, 30_000))
    rises = rng.random(t_us.size) < 0.5 * (1 + 0.3 * np.cos(2 * np.pi * hz * 1e-6 * t_us))
    assert SEARCH.loudest_hz(t_us.astype(np.int64), rises) == pytest.approx(
        hz, abs=0.005
    )  # a fortieth period in 5 s


def test_a_lamp_that_makes_events_twice_a_period_is_not_taken_for_a_faster_one() -> None:
    rng = np.random.default_rng(2)
    phase = 2 * np.pi * np.sort(rng.uniform(0, 500, 40_000))  # of 100 Hz, 5 s
    kept = rng.random(phase.size) < np.cos(phase) ** 2
    t_us = phase[kept] / (2 * np.pi * 100) * 1e6
    assert SEARCH.loudest_hz(t_us.astype(np.int64), np.cos(phase[kept]) > 0) == pytest.approx(100, abs=0.2)


@pytest.mark.parametrize("seed", range(5))
def test_no_lamp_is_made_of_the_loudest_of_chance_s_lines(seed: int) -> None:
    """n = 30 000 events at random, some 5000 independent lines: one of them is longer than 8 sqrt(n) in less
    than one of 10^24 runs."""
    rng = np.random.default_rng(seed)
    t_us = np.sort(rng.integers(0, 5_000_000, 30_000))
    assert SEARCH.loudest_hz(t_us, rng.random(t_us.size) < 0.5) == SEARCH.mains_hz


PAPER = Parameters.of("paper")
LAMP = Lamp("flicker", ("depth", "advance"), ((0.02, 1.0),), {"frequency_hz": 99.99, "phase_turns": 0.0})


@pytest.mark.parametrize("turns", [0.3, -0.2])
def test_the_phase_of_flickering_light(turns: float) -> None:
    rig = swaying()
    there = PAPER.changed({"flicker": {"frequency_hz": 99.99, "depth": 0.04, "phase_turns": turns}})
    found = SEARCH.in_step(rig, PAPER, LAMP, rig.events(there, [5])[0])
    assert found.others["frequency_hz"] == 99.99
    assert found.others["phase_turns"] == pytest.approx(turns, abs=0.01)


def test_no_phase_is_looked_for_where_no_lamp_is_to_be_heard() -> None:
    rig = swaying()
    assert SEARCH.in_step(rig, PAPER, LAMP, rig.events(PAPER, [5])[0]) is LAMP


def test_a_lamp_is_moved_on_by_a_quarter_turn_for_an_e_fold_of_its_second_size() -> None:
    lamp = replace(LAMP, others={**LAMP.others, "phase_turns": 0.4})
    found = [lamp.on(Parameters.of("paper"), (0.03, float(np.exp(e)))).flicker for e in (0.0, -1.0, 1.0)]
    assert [one.depth for one in found] == [0.03] * 3
    assert [one.phase_turns for one in found] == pytest.approx([0.4, 0.15, -0.35])  # 0.65 is the same phase
