"""Many frames given at once: `Simulator.advance_along`."""

from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

from voltcam_simulator import Law, Parameters, Simulator


def wave_going_by(width: int, height: int) -> list[tuple[NDArray[np.float32], int]]:
    """Frames at uneven times; the right half stands still."""
    y, x = np.indices((height, width))
    times_us = np.cumsum(np.random.default_rng(1).integers(500, 5000, 60))
    wave = [np.sin((x + y / 2 - t_us / 2000) / 3) * (x < width / 2) for t_us in times_us]
    return [((90 + 40 * one).astype(np.float32), int(t_us)) for one, t_us in zip(wave, times_us, strict=True)]


@pytest.mark.parametrize("law", ["exact", "paper"])
def test_pixels_do_along_a_path_of_light_what_they_do_frame_by_frame(law: Law) -> None:
    one, other = (Simulator(31, 16, Parameters.of("paper"), law, seed=3) for _ in range(2))
    frames = wave_going_by(31, 16)
    parts = one.advance_along(frames[:25]), one.advance_along([]), one.advance_along(iter(frames[25:]))
    events = np.concatenate([other.advance(frame, t_us) for frame, t_us in frames])
    assert len(events) > 1000
    np.testing.assert_array_equal(np.concatenate(parts), events)
    assert one.complete_us == other.complete_us


ACTIVE = {
    "contrast_response": {"k1": 60},  # more events in a stretch than there is space for at first
    "junction_leak": {"k4_per_us": 1e-5},
    "parasitic_photocurrent": {"k5_per_dn_us": 1e-7},
    "photon_noise": {"k3": 1e-3},
    "leak_noise": {"k6": 1e-4},
    "dark_current": {"dark_dn": 30},
    "input_response": {"gamma_exponent": 1.8, "pedestal_dn": 5},
    "low_light_shot_noise": {"c": 0.2},
    "vignetting": {"corner_loss": 0.6},
    "residual_drift": {"per_us": 1e-5, "power": -1, "across": 0.5, "down": -2},
    "residual_noise": {"variance_per_us": 1e-7, "power": -1},
}
"""Values at which the effects that several steps are seen through in one call do something."""


def test_the_effects_that_are_instant_are_all_tried() -> None:
    instant = {effect.name for effect in Parameters().effects() if effect.instant}
    assert instant == set(ACTIVE)


@pytest.mark.parametrize("changes", [
    *({name: values} for name, values in ACTIVE.items()),
    {"contrast_response": {"response": "linearised"}},
    {"leak_mismatch": {"sigma": 1}, "junction_leak": {"k4_per_us": 1e-5}},
    {"threshold_mismatch": {"sigma": 0.2}, "reset_noise": {"sigma": 0.1}},
    {"refractory_period": {"period_us": 3000}},
    {"photoreceptor_bandwidth": {"cutoff_hz": 300}},
    {"flicker": {"depth": 0.2}},
    {"temperature_drift": {"amplitude_c": 30, "period_s": 1}, "junction_leak": {"k4_per_us": 1e-5}},
])  # fmt: skip
def test_a_step_is_the_same_by_itself_and_among_others(changes: dict[str, dict[str, float]]) -> None:
    """Also where the same light comes twice, and where steps have all lengths."""
    parameters = Parameters.of("paper").changed(changes)
    one, other, plain = (Simulator(31, 16, each, seed=3) for each in (parameters, parameters, None))
    frames = wave_going_by(31, 16)
    even = [(frame, 1000 * n) for n, (frame, _) in enumerate(frames)]
    frames = even + [(frame, even[-1][1] + t_us) for frame, t_us in frames]
    events = np.concatenate([other.advance(frame, t_us) for frame, t_us in frames])
    np.testing.assert_array_equal(one.advance_along(frames), events)
    assert len(events) > 1000
    assert not np.array_equal(plain.advance_along(frames), events)
    for name, plane in one.snapshot().items():
        if not name.startswith("times_us"):
            np.testing.assert_allclose(plane, other.snapshot()[name], err_msg=name)


@pytest.mark.parametrize("changes", [
    {"latency": {"delay_us": 900, "jitter_us": 300}, "refractory_period": {"period_us": 500}},
    {"readout": {"event_us": 3, "row_us": 2}, "timestamp_quantum": {"quantum_us": 100}},
    {
        "hot_pixels": {"fraction": 0.1, "rate_hz": 200},
        "usb_overflow": {"max_rate_events_per_s": 5e4, "buffer_events": 200},
    },
    {"crosstalk": {"coupling": 0.02}},
    {"noise_pairs": {"rate_hz": 20}},
])  # fmt: skip
def test_along_a_path_of_light_effects_on_events_do_the_same_in_law(
    changes: dict[str, dict[str, float]],
) -> None:
    """Numbers of ON and OFF events and mean times, over 24 seeds: 5 standard errors, chance 1e-5 each."""
    parameters, frames = Parameters.of("paper").changed(changes), wave_going_by(31, 16)
    found = np.empty((2, 24, 4))
    for seed in range(24):
        one, other = (Simulator(31, 16, parameters, seed=seed) for _ in range(2))
        events = np.concatenate([other.advance(frame, t_us) for frame, t_us in frames])
        for way, each in enumerate((one.advance_along(frames), events)):
            on = each["p"]
            found[way, seed] = on.sum(), (~on).sum(), each["t"][on].mean(), each["t"][~on].mean()
            assert (np.diff(each["t"]) >= 0).all()
            assert each["t"][-1] <= frames[-1][1]
    error = np.sqrt(found.var(axis=1, ddof=1).sum(axis=0) / 24)
    assert (np.abs(found[0].mean(axis=0) - found[1].mean(axis=0)) < 5 * error).all()


@pytest.mark.parametrize("error", [ValueError, OSError])
def test_what_goes_wrong_on_a_path_of_light_leaves_the_sensor_at_the_frame_before(
    error: type[Exception],
) -> None:
    simulator, frames = Simulator(31, 16, Parameters.of("paper"), seed=3), wave_going_by(31, 16)

    def broken() -> Iterator[tuple[NDArray[np.float32], int]]:
        yield from frames[:20]
        if error is OSError:
            raise OSError
        yield -frames[20][0], frames[20][1]

    with pytest.raises(error):
        simulator.advance_along(broken())
    events = simulator.advance_along(frames[20:])
    assert events["t"][0] >= frames[19][1]
    assert len(events) > 1000
