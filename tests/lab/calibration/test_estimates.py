"""From logarithms and their errors to what a camera file and a report say."""

import numpy as np
import pytest

from voltcam_lab.calibration.estimates import (
    NORMAL_90,
    PAIRS,
    PLACES,
    correlations,
    estimates_of,
    likelihood_parameters,
    noise_shares,
)
from voltcam_lab.calibration.fit import NAMES, PRIOR, PRIOR_SD, named
from voltcam_lab.calibration.likelihood import START
from voltcam_simulator import Parameters

CENTRE = PRIOR.centre.copy()
NOISE = noise_shares(CENTRE, np.diag(PRIOR.sd**2))
"""What is usual: no recording has said anything of it."""


def estimates(sd: np.ndarray, log: np.ndarray = CENTRE) -> dict[str, object]:
    return {one.parameter: one for one in estimates_of(log, sd, NOISE)}


def test_the_camera_has_each_number_at_its_place() -> None:
    values = {name: START[name] * (1 + 0.1 * k) for k, name in enumerate(PLACES)} | {"on_over_off": 1.44}
    found = likelihood_parameters(values, dead_us=700.0, delay_us=-30.0)
    for name, (effect, parameter) in PLACES.items():
        assert getattr(getattr(found, effect), parameter) == pytest.approx(values[name])
    assert (found.comparator.theta_on, found.comparator.theta_off) == pytest.approx((1.2, 1 / 1.2))
    assert found.refractory_period.period_us == 700
    assert found.latency.delay_us == -30  # frames may be stamped after their light
    rest = set(Parameters.model_fields) - {effect for effect, _ in PLACES.values()}
    for effect in rest - {"comparator", "refractory_period", "latency"}:
        assert getattr(found, effect) == getattr(Parameters(), effect)


def test_noise_that_rounding_makes_negative_is_none() -> None:
    found = likelihood_parameters(START | {"k3": -1e-12}, 0.0, 0.0)
    assert found.photon_noise.k3 == 0


def test_each_parameter_is_listed_once_thresholds_last() -> None:
    names = [(one.effect, one.parameter) for one in estimates_of(CENTRE, PRIOR.sd, NOISE)]
    assert names == [*PLACES.values(), ("comparator", "theta_on"), ("comparator", "theta_off")]


def test_intervals_hold_a_normal_90_percent_of_the_logarithm() -> None:
    sd, log = 0.2 * PRIOR.sd, CENTRE + 0.3
    found = estimates(sd, log)
    one = found["k1"]
    assert one.value == pytest.approx(START["k1"] * np.exp(0.3))
    half = NORMAL_90 * 0.2 * PRIOR_SD["k1"]
    assert (one.low, one.high) == pytest.approx((one.value * np.exp(-half), one.value * np.exp(half)))
    wide = NORMAL_90 * PRIOR_SD["k1"]
    assert one.usual == pytest.approx((START["k1"] * np.exp(-wide), START["k1"] * np.exp(wide)))


def test_thresholds_share_their_ratio() -> None:
    """Half of its logarithm each, one the inverse of the other, with half its sd."""
    log = CENTRE.copy()
    log[NAMES.index("on_over_off")] = 0.4
    found = estimates(0.1 * PRIOR.sd, log)
    on, off = found["theta_on"], found["theta_off"]
    assert (on.value, off.value) == pytest.approx((np.exp(0.2), np.exp(-0.2)))
    assert on.value * off.value == pytest.approx(1)
    assert on.high / on.value == pytest.approx(np.exp(NORMAL_90 * 0.05 * PRIOR_SD["on_over_off"]))
    assert off.low == pytest.approx(1 / on.high)


@pytest.mark.parametrize(
    ("share", "rests_on", "determined"),
    [
        (0.1, "data", True),
        (0.49, "data", True),
        (0.51, "data and prior", False),
        (0.9, "prior", False),
        (2.0, "prior", False),
    ],
)
def test_what_it_rests_on_goes_by_the_share_of_the_prior_that_is_left(
    share: float, rests_on: str, determined: bool
) -> None:
    found = estimates(share * PRIOR.sd)
    for name in ("k1", "k5_per_dn_us", "theta_on"):
        assert (found[name].rests_on, found[name].determined) == (rests_on, determined), name
        assert found[name].informed == pytest.approx(max(1 - share, 0))


def test_noise_is_that_of_the_shares() -> None:
    found = estimates(PRIOR.sd)
    for k, name in enumerate(("k3", "k6")):
        assert (found[name].low, found[name].high) == NOISE.interval[k]
        assert found[name].value == pytest.approx(NOISE.value[k])
        assert found[name].rests_on == "prior"


def test_correlations_are_those_of_the_covariance() -> None:
    root = np.random.default_rng(1).normal(0, 1, (len(NAMES), len(NAMES)))
    covariance = root @ root.T
    found = correlations(covariance, NOISE)
    scale = np.sqrt(np.diag(covariance))
    for a, b in PAIRS:
        i, j = NAMES.index(a), NAMES.index(b)
        assert found[a, b] == pytest.approx(covariance[i, j] / scale[i] / scale[j])
    assert found["k3", "k6"] == NOISE.correlation
    assert len(found) == len(PAIRS) + 1


def test_usual_logarithms_are_the_usual_camera() -> None:
    values = named(CENTRE)
    for name in PLACES:
        assert values[name] == pytest.approx(START[name], rel=1e-3)
