"""The catalogue of effects that may be missing."""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_lab.diagnosis.catalogue.entries import (
    ENTRIES,
    acts_across_columns,
    catalogue,
    in_words,
    next_recording,
)
from voltcam_lab.diagnosis.catalogue.flicker import Lamp
from voltcam_lab.diagnosis.catalogue.temperature_drift import Warming
from voltcam_lab.diagnosis.catalogue.thresholds import ThresholdRatio
from voltcam_lab.models.exact import IN_THRESHOLDS, K1_TO_K6
from voltcam_simulator import Parameters
from voltcam_simulator.effects import EFFECTS

from ..made_rig import made_clues

CLUES = made_clues()
SCALED = [K1_TO_K6[name] for name in IN_THRESHOLDS]
INPUT_AND_BASE = {
    "contrast_response", "photon_noise", "junction_leak", "parasitic_photocurrent", "leak_noise",
    "dark_current", "residual_drift", "residual_noise",
}  # fmt: skip


def test_every_effect_of_the_registry_can_be_found() -> None:
    assert {one.effect for one in catalogue(CLUES)} == {effect.name for effect in EFFECTS} - INPUT_AND_BASE


@pytest.mark.parametrize("candidate", catalogue(CLUES), ids=lambda one: f"{one.effect}-{one.names[0]}")
def test_each_candidate_switches_its_effect_on_and_nothing_else(candidate) -> None:  # type: ignore[no-untyped-def]
    before = Parameters.of("paper")
    with_it = {effect for effect, _ in SCALED} if isinstance(candidate, ThresholdRatio) else set()
    for size in candidate.sizes:
        after = candidate.on(before, size)
        changed = {e.name for e, f in zip(before.effects(), after.effects(), strict=True) if e != f}
        assert changed == {candidate.effect} | with_it
        assert getattr(after, candidate.effect).active


def test_smaller_amounts_are_nearer_to_no_effect() -> None:
    of = {(one.effect, one.names[0]): one for one in catalogue(CLUES)}
    assert of["refractory_period", "period_us"].scaled((3000,), 0.5) == (1500,)
    assert of["photoreceptor_bandwidth", "cutoff_hz"].scaled((100,), 0.5) == (200,)
    assert of["comparator", "ratio"].scaled((4.0,), 0.5) == (2.0,)


@pytest.mark.parametrize(
    ("effect", "size", "possible"),
    [
        ("leak_mismatch", (2.9,), True),
        ("leak_mismatch", (3.1,), False),  # the registry ends at 3
        ("hot_pixels", (1.01 / 1728, 20.0), True),
        ("hot_pixels", (0.99 / 1728, 20.0), False),  # not one pixel
        ("hot_pixels", (0.01, 2e5), False),  # 100 kHz
        ("comparator", (1.3,), True),
        ("timestamp_quantum", (1.7,), True),
    ],
)
def test_sizes_beyond_limits_are_not_possible(effect: str, size: tuple[float, ...], possible: bool) -> None:
    assert next(one for one in catalogue(CLUES) if one.effect == effect).possible(size) == possible


def test_a_lamp_is_moved_on_by_a_quarter_turn_for_an_e_fold_of_its_second_size() -> None:
    lamp = next(one for one in catalogue(CLUES) if isinstance(one, Lamp))
    lamp = replace(lamp, others={**lamp.others, "phase_turns": 0.4})
    found = [lamp.on(Parameters.of("paper"), (0.03, float(np.exp(e)))).flicker for e in (0.0, -1.0, 1.0)]
    assert [one.depth for one in found] == [0.03] * 3
    assert [one.phase_turns for one in found] == pytest.approx([0.4, 0.15, -0.35])  # 0.65 is the same phase


def test_unequal_thresholds_keep_their_product_and_the_on_events() -> None:
    asymmetry = next(one for one in catalogue(CLUES) if one.effect == "comparator")
    before = Parameters.of("paper")
    after = asymmetry.on(before, (1.3,))
    comparator = after.comparator
    assert comparator.theta_on / comparator.theta_off == pytest.approx(1.3)
    assert comparator.theta_on * comparator.theta_off == pytest.approx(1)
    for effect, name in SCALED:
        now, then = (getattr(getattr(one, effect), name) for one in (after, before))
        assert now / comparator.theta_on == pytest.approx(then)


@pytest.mark.parametrize("rate", [3.0, -3.0])
def test_a_warming_passes_the_temperature_of_the_camera_file_in_the_middle(rate: float) -> None:
    warming = next(one for one in catalogue(CLUES) if isinstance(one, Warming))
    after = warming.on(Parameters.of("paper"), (rate,))
    assert after.temperature_c + rate * CLUES.seconds / 2 == pytest.approx(25)


def test_a_warming_begins_and_ends_where_a_camera_may_be() -> None:
    warming = next(one for one in catalogue(CLUES) if isinstance(one, Warming))
    long = replace(warming, seconds=60.0)
    assert [long.on(Parameters.of("paper"), (rate,)).temperature_c for rate in (10, -10)] == [-40, 125]


def test_sizes_stay_inside_the_limits_of_the_registry() -> None:
    paper = Parameters.of("paper")
    dead = next(one for one in catalogue(CLUES) if one.effect == "dead_pixels")
    assert dead.on(paper, (7.0,)).dead_pixels.fraction == 1
    tick = next(one for one in catalogue(CLUES) if one.effect == "timestamp_quantum")
    assert tick.on(paper, (3.4,)).timestamp_quantum.quantum_us == 3


def test_how_many_times_as_strong_as_it_is_looked_for() -> None:
    found = {(one.effect, one.names[0]): one for one in catalogue(CLUES)}
    assert found["dead_pixels", "fraction"].times((0.97,)) == pytest.approx(97)
    assert found["refractory_period", "period_us"].times((6000,)) == 2
    assert found["photoreceptor_bandwidth", "cutoff_hz"].times((20, 160)) == 4
    gamma, asymmetry = found["input_response", "gamma_exponent"], found["comparator", "ratio"]
    assert gamma.times((1.4**3,)) == pytest.approx(3)
    assert gamma.times((0.8**3,)) == pytest.approx(3)
    assert asymmetry.times((1.15**-2,)) == pytest.approx(2)
    assert found["temperature_drift", "rate_c_per_s"].times((-3 * 10 * np.log(2) / np.log(2.03) / 6,)) == (
        pytest.approx(3)
    )


def test_each_effect_has_one_entry_and_the_entry_its_own_candidates() -> None:
    assert len({entry.effect for entry in ENTRIES}) == len(ENTRIES)
    for entry in ENTRIES:
        assert {one.effect for one in entry.candidates(CLUES)} <= {entry.effect}
        assert entry.best_shown_by


@pytest.mark.parametrize(
    ("effect", "sizes"),
    [
        ("readout", {"event_us": 10}),
        ("residual_drift", {"per_us": 1e-6, "across": 0.5}),
        ("usb_overflow", {"max_rate_events_per_s": 1e5}),
        ("vignetting", {"corner_loss": 0.5}),
    ],
)
def test_effects_that_the_columns_share(effect: str, sizes: dict[str, float]) -> None:
    assert not acts_across_columns(Parameters.of("paper"))
    assert acts_across_columns(Parameters.of("paper").changed({effect: sizes}))


def test_rivals_are_told_apart_by_what_shows_either() -> None:
    found = next_recording("hot_pixels", ["dead_pixels", "reset_noise"])
    assert found == (
        "half a minute with the lens cap on, after some motion; and the same slow motion back and forth over"
        " every pixel, many times"
    )
    assert in_words("hot_pixels") == "hot pixels"
    assert in_words("comparator") == "unequal thresholds"
