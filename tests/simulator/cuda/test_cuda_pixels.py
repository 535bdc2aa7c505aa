"""Pixels in numba's simulator of a GPU: no figure and no event of these tests is from a device."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.simulator.scenes import intervals_us, only, watch_still

from voltcam_simulator import EVENT, Law, Limits, Parameters, Simulator, TooManyEventsError
from voltcam_simulator.cuda import cuda_pixels

WIDTH, HEIGHT, PERIOD_US = 12, 9, 16_667
ALL_LIGHT_AND_VOLTAGE = {
    "temperature_drift": {"rate_c_per_s": 1.0},
    "frame_noise": {"slack_dn": 2.0},
    "input_response": {"gamma_exponent": 2.2},
    "exposure_blur": {"exposure_us": 9000.0},
    "vignetting": {"corner_loss": 0.4},
    "flicker": {"depth": 0.2},
    "dark_current": {"dark_dn": 3.0},
    "photoreceptor_bandwidth": {"cutoff_hz": 300.0, "follower_hz": 700.0},
    "low_light_shot_noise": {"c": 0.0112},
    "residual_drift": {"per_us": 1e-6, "across": 0.3, "power": 0.7},
    "residual_noise": {"variance_per_us": 1e-9},
    "aps_coupling": {"exposure_kick": 0.1, "reset_kick": 0.05},
    "residual_clock": {"kick": 0.05, "period_us": 3000.0, "row_us": 20.0},
    "leak_mismatch": {"sigma": 0.2},
    "threshold_mismatch": {"sigma": 0.15},
    "residual_pattern": {"on": 0.3, "off": 0.2, "across_per_px": 0.25, "crest_turns": 0.1},
    "dead_pixels": {"fraction": 0.05},
    "refractory_period": {"period_us": 500.0},
    "reset_noise": {"sigma": 0.05},
}
EVENT_STAGES = {
    "hot_pixels": {"fraction": 0.05},
    "noise_pairs": {"rate_hz": 20.0},
    "residual_kick": {"after_on": -0.3, "after_off": 3.0, "chance": 0.5, "spread_decades": 0.2},
    "residual_coupling": {"after_on": 0.1, "after_off": -0.2, "delay_us": 20_000.0},
    "crosstalk": {"coupling": 0.02},
    "latency": {"delay_us": 100.0, "jitter_us": 20.0},
    "readout": {"event_us": 0.1},
}


def moving(frames: int) -> list[NDArray[np.uint8]]:
    """No row ever stands still: the CPU draws such rows by other numbers."""
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    waves = (np.sin((x + 3 * k) / 3.0) * np.cos((y - 2 * k) / 4.0) for k in range(frames))
    return [(128 + 100 * wave).astype(np.uint8) for wave in waves]


def both(parameters: Parameters, law: Law = "exact") -> tuple[Simulator, Simulator]:
    cpu, cuda = (
        Simulator(WIDTH, HEIGHT, parameters, law, seed=3, device=device) for device in ("cpu", "cuda")
    )
    return cpu, cuda


def events_of(simulator: Simulator, frames: list[NDArray[Any]], first: int = 0) -> NDArray[np.void]:
    return np.concatenate([simulator.advance(f, (first + k) * PERIOD_US) for k, f in enumerate(frames)])


@pytest.mark.parametrize("law", ["exact", "paper"])
@pytest.mark.parametrize("preset", ["typical", "noisy"])
def test_events_are_those_of_the_cpu(preset: str, law: Law) -> None:
    cpu, cuda = both(Parameters.of(preset), law)
    expected = events_of(cpu, moving(6))
    np.testing.assert_array_equal(events_of(cuda, moving(6)), expected)
    assert expected.size > 300


def test_all_effects_give_the_events_of_the_cpu_and_state_goes_from_one_to_the_other() -> None:
    parameters = Parameters().changed(ALL_LIGHT_AND_VOLTAGE).changed(EVENT_STAGES)
    assert all(effect.active for effect in parameters.effects() if effect.name in ALL_LIGHT_AND_VOLTAGE)
    cpu, cuda = both(parameters)
    frames = moving(9)
    np.testing.assert_array_equal(events_of(cuda, frames[:5]), expected := events_of(cpu, frames[:5]))
    assert expected.size > 100
    crossed = both(parameters)
    for simulator, other in zip(crossed, (cuda, cpu), strict=True):
        simulator.restore(other.snapshot())
        np.testing.assert_array_equal(
            np.concatenate([simulator.advance(f, (5 + k) * PERIOD_US) for k, f in enumerate(frames[5:])]),
            np.concatenate([other.advance(f, (5 + k) * PERIOD_US) for k, f in enumerate(frames[5:])]),
        )


def test_parameters_change_between_two_frames() -> None:
    cpu, cuda = both(Parameters.of("typical"))
    frames = moving(6)
    for simulator in (cpu, cuda):
        events_of(simulator, frames[:3])
        simulator.parameters = simulator.parameters.changed({"comparator": {"theta_on": 0.7}})
    np.testing.assert_array_equal(
        *(np.concatenate([s.advance(f, (3 + k) * PERIOD_US) for k, f in enumerate(frames[3:])])
          for s in (cpu, cuda))
    )  # fmt: skip


def test_pixels_with_more_events_than_a_thread_has_space_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """And more than the sensor has: nothing is lost, nothing comes twice."""
    monkeypatch.setattr(cuda_pixels, "FIRST_KEYS", 10)
    monkeypatch.setattr(cuda_pixels, "FIRST_ROOM", 20)
    cpu, cuda = both(only(contrast_response={"k1": 40.0}, leak_noise={"k6": 1e-5}))
    dark, bright = np.zeros((HEIGHT, WIDTH), np.uint8), np.full((HEIGHT, WIDTH), 255, np.uint8)
    expected = events_of(cpu, [dark, bright, dark])
    assert expected.size > 2 * 100 * WIDTH * HEIGHT  # 2.6 e-folds of 40 thresholds, up and down
    np.testing.assert_array_equal(events_of(cuda, [dark, bright, dark]), expected)


def test_too_many_events_are_given_up_and_it_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cuda_pixels, "FIRST_KEYS", 10)
    cuda = Simulator(WIDTH, HEIGHT, only(contrast_response={"k1": 40.0}), device="cuda")
    cuda.advance(np.zeros((HEIGHT, WIDTH), np.uint8), 0)
    with pytest.raises(TooManyEventsError):
        cuda.advance(np.full((HEIGHT, WIDTH), 255, np.uint8), 1000, Limits(most_events=1000))
    cuda.jump(np.zeros((HEIGHT, WIDTH), np.uint8), 2000)
    assert cuda.advance(np.zeros((HEIGHT, WIDTH), np.uint8), 3000).dtype == EVENT


def test_intervals_between_leak_events_are_inverse_gaussian() -> None:
    """First passage of a Brownian motion with drift: mean 1/mu, variance sigma^2/mu^3."""
    mu, sigma = 1e-4, 2e-3
    parameters = only(junction_leak={"k4_per_us": mu}, leak_noise={"k6": sigma})
    simulator = Simulator(16, 4, parameters, seed=7, device="cuda")
    events = watch_still(simulator, 100, 2, 25)
    between = intervals_us(events[events["p"]], 16)  # OFF: exp(-2 mu/sigma^2) = 2e-22 of them
    assert events["p"].all()
    mean, deviation = 1 / mu, np.sqrt(sigma**2 / mu**3)
    n = between.size
    assert n > 64 * 180
    # Five standard errors (wrong once in a million), and what an interval cut by the end is missing from.
    assert abs(between.mean() - mean) < 5 * deviation / np.sqrt(n) + mean * 64 / n
    assert abs(between.std() / deviation - 1) < 0.05  # its standard error is 0.8 %


def test_rates_without_drift_are_those_of_a_symmetric_exit() -> None:
    """From 0, Brownian motion leaves (-1, 1) after 1/sigma^2 on average, up or down alike."""
    sigma = 0.01
    simulator = Simulator(16, 4, only(leak_noise={"k6": sigma}), seed=8, device="cuda")
    events = watch_still(simulator, 100, 1, 25)
    expected = 64 * sigma**2 * 1e6  # 6400, of variance 2/3 of that for exits of this law
    assert abs(len(events) - expected) < 5 * np.sqrt(expected)
    assert abs(2 * int(events["p"].sum()) - len(events)) < 5 * np.sqrt(len(events))
