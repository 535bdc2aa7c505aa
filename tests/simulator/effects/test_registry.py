"""All effects together: what their order and their defaults promise."""

from pathlib import Path

import numpy as np
import pytest

from voltcam_simulator import Law, Parameters, Simulator, pixel_array
from voltcam_simulator.effect import Effect
from voltcam_simulator.effects import EFFECTS

NAMES = [effect.name for effect in EFFECTS]
BASE_MODEL = {
    "contrast_response",
    "photon_noise",
    "junction_leak",
    "parasitic_photocurrent",
    "leak_noise",
    "comparator",
}


def test_the_base_model_is_what_is_on_by_default() -> None:
    assert {effect.name for effect in Parameters().effects() if effect.active} == BASE_MODEL


@pytest.mark.parametrize(
    ("before", "behind"),
    [
        ("temperature_drift", "dark_current"),  # which asks for the temperature
        ("temperature_drift", "junction_leak"),
        ("frame_noise", "input_response"),  # which is of grey levels
        ("input_response", "exposure_blur"),  # means are of light, not of grey levels
        ("dark_current", "contrast_response"),
        ("contrast_response", "photoreceptor_bandwidth"),
        ("comparator", "threshold_mismatch"),
        ("threshold_mismatch", "dead_pixels"),
    ],
)
def test_who_must_come_before_whom(before: str, behind: str) -> None:
    assert NAMES.index(before) < NAMES.index(behind)


@pytest.mark.parametrize("effect", EFFECTS, ids=NAMES)
def test_every_effect_says_how_it_shows_and_has_a_test_of_that(effect: type[Effect]) -> None:
    assert len(effect.signature) > 10
    assert Path(__file__).with_name(f"test_{effect.name}.py").exists()


ALL_OF_THE_PIXEL = {
    "temperature_drift": {"rate_c_per_s": 5},
    "frame_noise": {"slack_dn": 3},
    "input_response": {"gamma_exponent": 2.2, "black_level_dn": 16},
    "exposure_blur": {"exposure_us": 3000},
    "vignetting": {"corner_loss": 0.3},
    "flicker": {"depth": 0.2},
    "dark_current": {"dark_dn": 2},
    "photoreceptor_bandwidth": {"cutoff_hz": 300, "follower_hz": 2000},
    "low_light_shot_noise": {"c": 0.0112},
    "aps_coupling": {"exposure_kick": 0.1, "reset_kick": 0.2, "readout_kick": -0.1},
    "residual_clock": {"kick": 0.1, "period_us": 7000, "row_us": -20},
    "leak_mismatch": {"sigma": 0.3},
    "threshold_mismatch": {"sigma": 0.3},
    "residual_pattern": {"on": 0.3, "off": -0.2, "across_per_px": 0.25, "down_per_px": 0.05},
    "dead_pixels": {"fraction": 0.01},
    "refractory_period": {"period_us": 500},
    "reset_noise": {"sigma": 0.1},
}

ALL_BEHIND_IT = {
    "hot_pixels": {"fraction": 0.05, "rate_hz": 50},
    "noise_pairs": {"rate_hz": 50, "interval_us": 1000},
    "residual_kick": {"after_on": 0.4, "after_off": 0.4, "delay_us": 700},
    "residual_coupling": {"after_on": 0.1, "after_off": 0.1, "delay_us": 700},
    "crosstalk": {"coupling": 0.1},
    "latency": {"delay_us": -5000, "jitter_us": 100},
    "row_request": {"wait_us": 40},
    "arbiter_scan": {"round_us": 252, "busy_per_us": 0.01, "burst_per_us": 0.05},
    "readout": {"row_us": 0.3, "event_us": 0.083, "start_us": 2},
    "usb_overflow": {"max_rate_events_per_s": 1e4, "buffer_events": 50},
    "timestamp_quantum": {"quantum_us": 7},
}
PERIODS_US = 20_160_000
"""Of all that has a period above, a multiple."""


@pytest.mark.parametrize("effect", sorted(ALL_OF_THE_PIXEL | ALL_BEHIND_IT))
def test_a_time_line_may_begin_before_zero(effect: str) -> None:
    """Kicks that come later draw by the time of the event: their counts have 2 sd of Poisson here."""
    parameters = Parameters().changed({effect: (ALL_OF_THE_PIXEL | ALL_BEHIND_IT)[effect]})
    image = np.random.default_rng(0).integers(0, 256, (24, 140)).astype(np.float32)

    def run(begin_us: int) -> np.ndarray:
        simulator = Simulator(30, 24, parameters, seed=1)
        seen = [simulator.advance(image[:, k : k + 30], begin_us + 5000 * k) for k in range(40)]
        events = np.concatenate(seen)
        events["t"] -= begin_us
        return events

    usual, early = run(0), run(-PERIODS_US)
    if effect in ("residual_kick", "residual_coupling"):
        assert len(early) == pytest.approx(len(usual), abs=2 * np.sqrt(len(usual)))
    else:
        assert early.tobytes() == usual.tobytes()


@pytest.mark.parametrize("law", ["exact", "paper"])
def test_all_together_do_not_see_bands_and_survive_any_light(
    law: Law, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Black, four times white, steps of a microsecond and of 0.1 s."""
    rng = np.random.default_rng(1)
    frames = [rng.uniform(0, 255, (50, 70)).astype(np.float32) for _ in range(4)]
    frames += [np.zeros((50, 70)), np.full((50, 70), 1000.0), np.zeros((50, 70)), frames[0]]
    times = [0, 5000, 5001, 40_000, 50_000, 60_000, 160_000, 170_000]
    runs = []
    for band_pixels in (16384, 1000, 1):
        monkeypatch.setattr(pixel_array, "BAND_PIXELS", band_pixels)
        parameters = Parameters.of("typical").changed(ALL_OF_THE_PIXEL)
        simulator = Simulator(70, 50, parameters, law=law, seed=1)
        events = [simulator.advance(frame, t) for frame, t in zip(frames, times, strict=True)]
        for k in range(1, len(times)):
            t = events[k]["t"]
            assert (np.diff(t) >= 0).all()
            assert len(t) == 0 or times[k - 1] <= t[0] <= t[-1] <= times[k]
        assert len(events[1]) > 3500
        runs.append(np.concatenate(events).tobytes())
    assert runs[0] == runs[1] == runs[2]
