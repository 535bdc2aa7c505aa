"""Models with effects in them, on a rig whose answers are formulas."""

import numpy as np

from voltcam_lab.diagnosis.model import EFFECT_SHARE, Model, spread_of

from .made_rig import MISMATCH, PATTERNS, START, MadeRig


def test_a_share_of_what_the_model_s_effects_do_counts_as_spread_where_more_is_looked_for() -> None:
    """Mismatch does 10 sigma times its pattern; the lenient spread has a tenth of that in it, v has not."""
    without, added = (
        spread_of(MadeRig(), model, range(8))
        for model in (Model(START), Model(START).with_effect(MISMATCH, (0.3,)))
    )
    np.testing.assert_array_equal(without.lenient, without.v)
    more = np.sqrt(added.lenient**2 - added.v**2)
    step = np.expm1(0.15) / 0.15  # derivatives are taken over a step of the logarithm
    np.testing.assert_allclose(more, EFFECT_SHARE * step * np.abs(3 * PATTERNS[7]), rtol=1e-4, atol=1e-4)
