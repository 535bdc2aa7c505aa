"""One step of one band: what its effects add up to, and where it stands afterwards."""

import numpy as np
import pytest

from voltcam_simulator import Law, Parameters
from voltcam_simulator.band_state import BandState
from voltcam_simulator.band_step import BandStepper
from voltcam_simulator.effect import Band
from voltcam_simulator.fixed_pattern import lay_down
from voltcam_simulator.groups import AheadRows, Motion, Pixels
from voltcam_simulator.kicks import no_kicks
from voltcam_simulator.random import CROSSINGS, interval_key
from voltcam_simulator.workspace import Workspace

from .scenes import only

WIDTH, ROWS = 3, 2
PIXELS = WIDTH * ROWS
KEY = interval_key(1, CROSSINGS, 0)


def stepping(parameters: Parameters, law: Law = "exact") -> tuple[BandStepper, BandState]:
    """The lower two of three rows of a sensor, at 10 DN and at rest."""
    pattern = lay_down(WIDTH, 3, 1, law, parameters, {})
    workspace = Workspace(PIXELS)
    light, response, drift, noise, *bend = workspace.planes
    before = np.full(PIXELS, 10, np.float32)
    band = Band(pattern.sensor, 1, 0, 0.0, 0.0, 25.0, before, light, response, drift, noise, *bend)
    zeros, ones = (np.full(PIXELS, v, np.float32) for v in (0, 1))
    rows = AheadRows(
        np.zeros(ROWS, np.int32), np.zeros(ROWS, np.bool_), np.zeros(ROWS, np.float32), zeros.copy(),
        zeros.copy(), np.zeros((PIXELS, 2), np.float32),
    )  # fmt: skip
    state = BandState(
        workspace, band, WIDTH, WIDTH, Pixels(zeros.copy(), zeros.copy(), zeros.copy(), ones, ones),
        Motion(drift, noise), rows, before, zeros.copy(), no_kicks(zeros), has_held=False,
    )  # fmt: skip
    return BandStepper(law, pattern), state


def image(*rows: float) -> np.ndarray:
    return np.repeat(np.array(rows, np.float32), WIDTH)


def test_a_band_sees_its_rows_of_the_image_through_its_effects() -> None:
    stepper, state = stepping(
        only(contrast_response={"k1": 2, "k2_dn": 20}, dark_current={"dark_dn": 5, "doubling_c": 8})
    )
    band = stepper.see(state, image(99, 30, 75), 1000, 250.0, 7.0)
    assert (band.start_us, band.span_us, band.end_us, band.elapsed_us) == (1000, 250, 1250, 7)
    np.testing.assert_allclose(band.light, image(35, 80))
    np.testing.assert_allclose(band.response, 2 * np.log(image(55, 100)), rtol=1e-6)


def test_drift_adds_up_and_independent_noise_adds_in_squares() -> None:
    stepper, state = stepping(
        only(
            junction_leak={"k4_per_us": 1e-6},
            parasitic_photocurrent={"k5_per_dn_us": 1e-7},
            leak_noise={"k6": 3e-4},
            photon_noise={"k3": 1e-3},
        )
    )
    band = stepper.see(state, image(0, 30, 30), 0, 500.0, 0.0)
    for _ in range(2):  # nothing is left of the step before
        stepper.add_drift(band)
    np.testing.assert_allclose(band.drift, 500 * (1e-6 + 1e-7 * 20), rtol=1e-6)
    shared = 3e-4 + 1e-3 * np.sqrt(20) / (20 + 20)  # terms of one Wiener process
    np.testing.assert_allclose(band.noise, shared, rtol=1e-6)
    independent, state = stepping(only(leak_noise={"k6": 3e-4}, residual_noise={"variance_per_us": 1.6e-7}))
    band = independent.see(state, image(0, 10, 10), 0, 500.0, 0.0)
    independent.add_drift(band)
    np.testing.assert_allclose(band.noise, np.hypot(3e-4, 0.4e-3), rtol=1e-6)


@pytest.mark.parametrize(("law", "change"), [("exact", 5 * np.log(50 / 30)), ("paper", 5 * 20 / 40)])
def test_events_and_the_rest_of_the_voltage_add_up_to_the_change_of_response(law: Law, change: float) -> None:
    stepper, state = stepping(only(contrast_response={"k1": 5, "k2_dn": 20}), law)
    stepper.see(state, image(0, 10, 10), 0, 0.0, 0.0)
    state.response[:] = state.band.response
    band = stepper.see(state, image(0, 30, 10), 0, 1000.0, 0.0)
    stepper.add_drift(band)
    stepper.draw_events(state, KEY, 0.0)
    keys = state.workspace.take_keys()
    assert len(keys) == WIDTH * int(change)
    assert set((keys >> np.uint64(14) & np.uint64(0x1FFF)).tolist()) == {1}  # row 1 of the sensor brightens
    np.testing.assert_allclose(state.pixels.voltage, image(change % 1, 0), atol=1e-5)
    np.testing.assert_array_equal(state.light, image(30, 10))


def test_a_kick_counts_once() -> None:
    """0.4 up in the step: the voltage is there at its end, and the next step adds nothing."""
    stepper, state = stepping(only())
    band = stepper.see(state, image(0, 10, 10), 0, 1000.0, 0.0)
    stepper.add_drift(band)
    band.kicks.append((np.array([300.0, 2000.0]), 0.4))  # the second row has it in another step
    stepper.draw_events(state, KEY, 0.0)
    np.testing.assert_allclose(state.pixels.voltage, image(0.4, 0), atol=1e-6)
    stepper.add_drift(stepper.see(state, image(0, 10, 10), 1000, 1000.0, 0.0))
    stepper.draw_events(state, KEY, 0.0)
    np.testing.assert_allclose(state.pixels.voltage, image(0.4, 0), atol=1e-6)


def test_a_band_may_be_worked_on_in_any_workspace() -> None:
    stepper, state = stepping(only(contrast_response={"k1": 5, "k2_dn": 20}))
    other = Workspace(2 * PIXELS)  # of a thread that has larger bands, too
    stepper.see(state, image(0, 10, 10), 0, 0.0, 0.0)
    state.response[:] = state.band.response
    first = state.workspace
    state.work_in(other)
    band = stepper.see(state, image(0, 30, 10), 0, 1000.0, 0.0)
    stepper.add_drift(band)
    stepper.draw_events(state, KEY, 0.0)
    assert len(other.take_keys()) == WIDTH * 2
    assert first.take_keys().size == 0
    assert state.band.light.base is other.planes
