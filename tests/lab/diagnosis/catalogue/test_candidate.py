"""Sizes of effects: how strong they are, and which are possible."""

import numpy as np
import pytest

from voltcam_lab.diagnosis.catalogue.entries import catalogue
from voltcam_simulator import Parameters

from ..made_rig import made_clues

CLUES = made_clues()


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
