"""What a recording can tell."""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_lab.diagnosis.search.hypothesis import BASE
from voltcam_lab.diagnosis.search.identify import answer_of, detectable_sizes, short, smallest
from voltcam_lab.diagnosis.search.spread import flat

from ..conftest import Done


def test_every_base_parameter_and_every_candidate_is_in_the_table(done: Done) -> None:
    assert [(one.effect, one.name) for one in done.identifiability.base] == list(BASE)
    assert {one.effect for one in done.identifiability.effects} == {
        one.effect for one in done.session.candidates
    }
    text = done.identifiability.text()
    for one in done.identifiability.base:
        assert f"{one.effect}.{one.name}" in text
    assert "seen from" in text


def test_a_moving_scene_fixes_the_gain_better_than_a_prior_does(done: Done) -> None:
    gain = done.identifiability.base[0]
    assert gain.answer == "yes"
    assert gain.sd < 0.1


def test_the_hidden_effect_is_far_above_the_smallest_size_that_shows(done: Done) -> None:
    (dead,) = [one for one in done.identifiability.effects if one.effect == "refractory_period"]
    assert dead.size is not None
    assert 1 < dead.size < 3000  # 6000 us are hidden
    assert smallest(dead).endswith(" us")


def test_the_gain_at_the_smallest_size_is_what_chance_reaches(done: Done) -> None:
    screen = done.diagnosis.steps[0].screen
    size = next(one.size for one in detectable_sizes(screen) if one.effect == "vignetting")
    one = next(one for one in screen.signatures if one.candidate.effect == "vignetting")
    assert size is not None
    z = size / one.size[0] * flat(one.column)
    gain = screen.with_effect(z, one).gain - screen.own(z).gain
    assert gain >= 30  # ScoreTest.least_gain; chance may ask for more
    less = 0.8 * z
    assert screen.with_effect(less, one).gain - screen.own(less).gain < gain


def test_less_than_a_pixel_is_not_given_as_a_share_that_would_be_found(done: Done) -> None:
    screen = done.diagnosis.steps[0].screen
    few = replace(screen.signatures[0], candidate=replace(screen.signatures[0].candidate, least=1e9))
    (found,) = detectable_sizes(replace(screen, signatures=(few,)))
    assert found.size == 1e9


def test_the_covariance_is_one(done: Done) -> None:
    found = done.diagnosis.covariance
    assert found is not None
    np.testing.assert_allclose(found, found.T, rtol=1e-6, atol=1e-12)
    assert np.linalg.eigvalsh(found).min() > 0
    assert len(found) == len(BASE) + 1  # and the effect's size


def test_parameters_that_move_together_are_named_by_each_other(done: Done) -> None:
    found = {one.name: one for one in done.identifiability.base}
    for one in found.values():
        for partner, correlation in one.mixed_with.items():
            assert found[partner].mixed_with[one.name] == pytest.approx(correlation)


@pytest.mark.parametrize(("share", "answer"), [(0.99, "yes"), (0.7, "in part"), (0.1, "no")])
def test_answers(share: float, answer: str) -> None:
    assert answer_of(share) == answer


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (6104.6, "6100"),
        (0.0, "0"),
        (1.08e-7, "1.08e-07"),
        (18.13, "18.1"),
        (0.00523, "0.00523"),
        (-3.0, "-3.00"),
    ],
)
def test_numbers_are_short(number: float, text: str) -> None:
    assert short(number) == text
