"""The catalogue of effects that may be missing."""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_lab.diagnosis.catalogue.candidate import Candidate
from voltcam_lab.diagnosis.catalogue.clues import Clues
from voltcam_lab.diagnosis.catalogue.entries import ENTRIES, catalogue
from voltcam_lab.diagnosis.catalogue.flicker import Lamp
from voltcam_lab.diagnosis.catalogue.temperature_drift import Warming
from voltcam_lab.diagnosis.catalogue.thresholds import ThresholdRatio
from voltcam_lab.diagnosis.search.model import Model
from voltcam_lab.diagnosis.search.unlisted import STEEP, forms
from voltcam_simulator import Parameters
from voltcam_simulator.effects import EFFECTS

CLUES = Clues(6.0, 50_000, 100.0, 40_000, 500, 35.25, 36, 1234.0, 1, 1728)
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


@pytest.mark.parametrize("log", [-30.0, 20.0])
@pytest.mark.parametrize("candidate", catalogue(CLUES), ids=lambda one: one.effect)
def test_a_fit_that_goes_astray_meets_the_limits_and_not_an_error(candidate: Candidate, log: float) -> None:
    """Of a real recording, with a published camera file, k2 went beyond 10 000 DN."""
    model = Model(Parameters.of("paper")).with_effect(candidate, candidate.sizes[0])
    parameters = model.parameters([log] * len(model.shift))
    assert parameters == Parameters.model_validate(parameters.model_dump())
    assert (parameters.contrast_response.k2_dn == 10_000) == (log > 0)


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


def test_a_model_knows_its_base_and_its_effects() -> None:
    start = Parameters.of("paper")
    dead_time = next(one for one in catalogue(CLUES) if one.effect == "refractory_period")
    model = Model(start).with_effect(dead_time, (1000.0,))
    moved = model.parameters([0.1, 0, 0, 0, 0, 0, 0.2])
    assert moved.contrast_response.k1 == pytest.approx(start.contrast_response.k1 * 1.10517, rel=1e-4)
    assert moved.refractory_period.period_us == pytest.approx(1221.4, rel=1e-4)
    assert model.without(0).parameters() == start


def test_forms_of_the_open_route_are_drifts_and_noises() -> None:
    assert {one.effect for one in forms(Parameters.of("paper"))} == {"residual_drift", "residual_noise"}


def test_drifts_are_tried_either_way_below_and_above_the_leak() -> None:
    """A small one slows the leak, a large one turns it round: neither is the other's multiple."""
    start = Parameters.of("paper")
    leak = start.junction_leak.k4_per_us + 128 * start.parasitic_photocurrent.k5_per_dn_us
    for form in forms(start):
        if form.effect == "residual_drift":
            found = [form.on(start, size).residual_drift for size in form.sizes]
            most = [one.per_us * max(1, one.across, one.down) / leak for one in found]
            ways_and_sizes = {(size > 0, abs(size) > 1) for size in most}
            assert ways_and_sizes == {(True, True), (True, False), (False, True), (False, False)}


def test_across_the_image_nothing_is_looked_for_in_strips_of_it() -> None:
    start = Parameters.of("paper")
    of_strips = forms(start, whole=False)
    assert [one.others for one in forms(start) if one not in of_strips] == [{"power": 0.0, "across": STEEP}]


@pytest.mark.parametrize("axis", ["across", "down"])
def test_slopes_over_the_image_have_next_to_no_drift_in_the_middle(axis: str) -> None:
    start = Parameters.of("paper")
    (slope,) = (one for one in forms(start) if axis in one.others)
    for size in slope.sizes:
        drift = slope.on(start, size).residual_drift
        assert abs(drift.per_us) < 0.2 * abs(drift.per_us * getattr(drift, axis))


def test_a_leak_that_a_camera_file_does_not_have_can_be_found() -> None:
    dry = Parameters.of("paper").changed({"junction_leak": {"k4_per_us": 0}})
    low, high = (Model(dry).parameters([0, 0, 0, log, 0, 0]).junction_leak.k4_per_us for log in (0, 2))
    assert 0 < low < 1e-9  # an event of a pixel in more than a quarter of an hour
    assert high == pytest.approx(low * np.exp(2))
