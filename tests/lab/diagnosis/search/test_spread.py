"""Twins of hypotheses with effects in them, on a rig whose answers are formulas."""

from collections.abc import Sequence

import numpy as np
import pytest

from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.robust import huber
from voltcam_lab.diagnosis.search.settings import DEFAULTS
from voltcam_lab.diagnosis.search.spread import slopes_of, spread_of
from voltcam_lab.statistics import Values
from voltcam_simulator import Parameters

from ..made_rig import MISMATCH, PATTERNS, START, MadeRig, logs


def test_a_share_of_what_the_model_s_effects_do_counts_as_spread_where_more_is_looked_for() -> None:
    """Mismatch does 10 sigma times its pattern; the inflated sd has a tenth of that in it, the sd has not."""
    without, added = (
        spread_of(MadeRig(), hypothesis, range(8), DEFAULTS)
        for hypothesis in (Hypothesis(START), Hypothesis(START).with_effect(MISMATCH, (0.3,)))
    )
    np.testing.assert_array_equal(without.inflated_sd, without.sd)
    more = np.sqrt(added.inflated_sd**2 - added.sd**2)
    step = 2 * np.sinh(0.25) / 0.5  # derivatives are taken over a step of the logarithm
    np.testing.assert_allclose(
        more, DEFAULTS.model_error.effect_share * step * np.abs(3 * PATTERNS[7]), rtol=1e-4, atol=1e-4
    )


def test_chance_leaves_of_a_twin_that_is_left_out_what_it_leaves_of_a_new_one() -> None:
    """Within 5 %: a twin that is left out is held against 21 others, a new one against 28. In units of a
    spread that it has a part in, a twin's loss is 10 % too low."""
    rig = MadeRig(lambda _: np.zeros_like(PATTERNS[0]))
    spread = spread_of(rig, Hypothesis(START), DEFAULTS.runs.twins, DEFAULTS)
    new = [huber((rig.noise(seed) - spread.mean) / spread.sd, DEFAULTS.huber_z).mean() for seed in range(100)]
    left_out, within = (
        np.mean([huber(z, DEFAULTS.huber_z).mean() for z in zs])
        for zs in (spread.left_out, [(twin - spread.mean) / spread.sd for twin in spread.twins])
    )
    assert left_out == pytest.approx(np.mean(new), rel=0.05)
    assert within < 0.92 * np.mean(new)


class BlinkingRig(MadeRig):
    """One whose light, if noisier, adds 3 times a pattern."""

    def run(
        self, parameters: Parameters, seeds: Sequence[int], apart: bool = False, noisier: bool = False
    ) -> Values:
        return super().run(parameters, seeds) + 3 * noisier * PATTERNS[8]


def test_each_statistic_may_be_off_by_what_noisier_light_does_to_it() -> None:
    plain, blinking = (
        spread_of(rig, Hypothesis(START), range(8), DEFAULTS) for rig in (MadeRig(), BlinkingRig())
    )
    assert not plain.light.any()
    np.testing.assert_allclose(blinking.light, 3 * PATTERNS[8], atol=1e-9)
    np.testing.assert_allclose(blinking.sd**2, plain.sd**2 + blinking.light**2)
    np.testing.assert_allclose(blinking.mean, plain.mean)


def curved(parameters: Parameters) -> Values:
    k1 = logs(parameters)[0]
    return 100 + (3 * k1 + 40 * k1**2) * PATTERNS[0]


def test_slopes_are_those_of_the_place_and_not_of_a_step_away() -> None:
    found = slopes_of(MadeRig(curved), Hypothesis(START), range(2), DEFAULTS)
    np.testing.assert_allclose(found[..., 0], 3 * PATTERNS[0], atol=1e-6)
    assert not found[..., 1:].any()
