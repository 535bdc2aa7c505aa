"""Models with effects in them, on a rig whose answers are formulas."""

import numpy as np
import pytest

from voltcam_lab.diagnosis.rig.rig import Values
from voltcam_lab.diagnosis.search.model import EFFECT_SHARE, Model, slopes, spread_of
from voltcam_lab.diagnosis.search.robust import loss
from voltcam_lab.diagnosis.search.step import TWINS
from voltcam_simulator import Parameters

from .made_rig import MISMATCH, PATTERNS, START, MadeRig, logs


def test_a_share_of_what_the_model_s_effects_do_counts_as_spread_where_more_is_looked_for() -> None:
    """Mismatch does 10 sigma times its pattern; the lenient spread has a tenth of that in it, v has not."""
    without, added = (
        spread_of(MadeRig(), model, range(8))
        for model in (Model(START), Model(START).with_effect(MISMATCH, (0.3,)))
    )
    np.testing.assert_array_equal(without.lenient, without.v)
    more = np.sqrt(added.lenient**2 - added.v**2)
    step = 2 * np.sinh(0.25) / 0.5  # derivatives are taken over a step of the logarithm
    np.testing.assert_allclose(more, EFFECT_SHARE * step * np.abs(3 * PATTERNS[7]), rtol=1e-4, atol=1e-4)


def test_chance_leaves_of_a_twin_that_is_left_out_what_it_leaves_of_a_new_one() -> None:
    """Within 5 %: a twin that is left out is held against 21 others, a new one against 28. In units of a
    spread that it has a part in, a twin's loss is 10 % too low."""
    rig = MadeRig(lambda _: np.zeros_like(PATTERNS[0]))
    spread = spread_of(rig, Model(START), TWINS)
    new = [loss((rig.noise(seed) - spread.mean) / spread.v).mean() for seed in range(100)]
    left_out, within = (
        np.mean([loss(z).mean() for z in zs])
        for zs in (spread.left_out, [(twin - spread.mean) / spread.v for twin in spread.twins])
    )
    assert left_out == pytest.approx(np.mean(new), rel=0.05)
    assert within < 0.92 * np.mean(new)


def test_a_camera_file_without_a_leak_is_not_one_of_another_camera() -> None:
    """It has nothing to be so many times of; one with a leak is."""
    far = (0.0, 0.0, 0.0, 0.0, 2.0, 0.0)
    assert Model(START, (), far).far_off == {"k5_per_dn_us": pytest.approx(np.exp(2))}
    assert not Model(Parameters.of("ideal"), (), far).far_off


def bent(parameters: Parameters) -> Values:
    k1 = logs(parameters)[0]
    return 100 + (3 * k1 + 40 * k1**2) * PATTERNS[0]


def test_slopes_are_those_of_the_place_and_not_of_a_step_away() -> None:
    found = slopes(MadeRig(bent), Model(START))
    np.testing.assert_allclose(found[..., 0], 3 * PATTERNS[0], atol=1e-6)
    assert not found[..., 1:].any()
