"""What is in step with the clock, on a clock that begins elsewhere."""

import numpy as np
import pytest
from numpy.typing import NDArray

from voltcam_lab.diagnosis.catalogue.flicker import later_turns
from voltcam_lab.diagnosis.rig.clock import counted_from
from voltcam_simulator import Parameters, Simulator

ORIGIN_US, FROM_1970_US = 3 * 4_032_000, 394_137_000 * 4_032_000
LAMP = {"flicker": {"frequency_hz": 120, "depth": 0.2, "phase_turns": 0.3}}
READOUT = {"aps_coupling": {"frame_period_us": 25_000.5, "offset_us": 700, "exposure_kick": 0.3}}
CLOCK = {
    "residual_clock": {"period_us": 33_333.333_333, "begin_us": 1200, "kick": 0.3},
    "junction_leak": {"k4_per_us": 1e-5},  # events as voltages rise, and most of them in step
}


def seen_from(parameters: Parameters, t_us: int) -> NDArray[np.void]:
    simulator = Simulator(8, 8, parameters, seed=1)
    simulator.advance(np.full((8, 8), 100, np.uint8), t_us)
    events = simulator.advance(np.full((8, 8), 110, np.uint8), t_us + 500_000)
    events["t"] -= t_us
    return events


@pytest.mark.parametrize("effect", [LAMP, READOUT, CLOCK])
@pytest.mark.parametrize("origin_us", [ORIGIN_US, FROM_1970_US])
def test_a_camera_sees_the_same_with_the_clock_counted_from_elsewhere(
    effect: dict[str, dict[str, float]], origin_us: int
) -> None:
    parameters = Parameters().changed(effect)
    there = seen_from(parameters, origin_us)
    assert len(there) > 50
    moved = counted_from(parameters, origin_us)
    here = seen_from(moved, 0)
    assert len(here) == len(there)
    assert np.abs(here["t"] - there["t"]).max() <= 1
    assert len(seen_from(parameters, 0)) != len(there) or (seen_from(parameters, 0)["t"] != there["t"]).any()
    back = counted_from(moved, -origin_us)
    assert back.flicker.phase_turns == pytest.approx(parameters.flicker.phase_turns)
    assert back.aps_coupling.offset_us == pytest.approx(parameters.aps_coupling.offset_us)
    assert back.residual_clock.begin_us == pytest.approx(parameters.residual_clock.begin_us)


def test_what_is_not_in_step_stays() -> None:
    parameters = Parameters.of("typical")
    assert counted_from(parameters, ORIGIN_US) is parameters


def test_turns_are_the_nearest() -> None:
    assert later_turns(0.2, 100, 4_000) == pytest.approx(-0.4)
    assert later_turns(0.2, 100, -10_000) == pytest.approx(0.2)
