"""The biases of a DAVIS: what their currents do to the parameters, and back."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from voltcam_simulator import Parameters
from voltcam_simulator.biases import USUAL, Biases, biases_of, changes_for, with_changes

CAMERA = Parameters.of("typical")


def at(**changes: int) -> Parameters:
    return CAMERA.changed(changes_for(with_changes(Biases(), changes), CAMERA))


@pytest.mark.parametrize("name", ["davis346", "davis240c", "typical", "paper", "noisy"])
def test_at_the_usual_biases_a_camera_is_as_it_says(name: str) -> None:
    camera = Parameters.of(name)
    changed = camera.changed(changes_for(Biases(), camera))
    assert changed == camera
    assert biases_of(camera, camera, Biases()) == Biases()


def test_twice_the_current_is_half_the_dead_time_and_twice_the_speed() -> None:
    assert at(RefrBp_fine=50).refractory_period.period_us == pytest.approx(500)
    assert at(RefrBp_coarse=3).refractory_period.period_us == pytest.approx(8000)
    assert at(PrBp_fine=29).photoreceptor_bandwidth.cutoff_hz == pytest.approx(150)
    assert at(PrSFBp_coarse=0).photoreceptor_bandwidth.follower_hz == pytest.approx(3000 / 8)


def test_thresholds_go_as_the_logarithm_of_the_ratio_to_diff() -> None:
    usual = math.log(64 * 200 / 39)
    more = at(ONBn_fine=100).comparator
    assert more.theta_on == pytest.approx(math.log(64 * 100 / 39) / usual)
    assert more.theta_off == 1
    both = at(DiffBn_fine=78).comparator
    assert both.theta_on == pytest.approx(math.log(64 * 200 / 78) / usual)
    assert both.theta_off == pytest.approx(math.log(78 / 0.5) / math.log(39 / 0.5))


def test_no_bias_takes_a_parameter_beyond_its_limits() -> None:
    assert at(RefrBp_coarse=0, RefrBp_fine=0).refractory_period.period_us == 1e6
    assert at(PrBp_coarse=7, PrBp_fine=255).photoreceptor_bandwidth.cutoff_hz == 1e5
    assert at(ONBn_coarse=0).comparator.theta_on == 0.001  # below DiffBn: a pixel that fires without end
    assert at(OFFBn_coarse=7).comparator.theta_off == 0.001


@pytest.mark.parametrize(
    "changes", [{"ONBn_fine": 256}, {"OnBn_fine": 3}, {"PrBp_coarse": True}, {"PrBp_fine": 2.5}]
)
def test_what_is_no_bias_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(ValidationError, match=next(iter(changes))):
        with_changes(Biases(), changes)


CHANGES = st.fixed_dictionaries(
    {},
    optional={
        "DiffBn_fine": st.integers(20, 80),
        "ONBn_fine": st.integers(2, 255),
        "OFFBn_fine": st.integers(0, 19),
        "PrBp_coarse": st.integers(0, 4),
        "PrBp_fine": st.integers(0, 255),
        "PrSFBp_fine": st.integers(0, 255),
        "RefrBp_coarse": st.integers(2, 6),
        "RefrBp_fine": st.integers(16, 255),
    },
)


@given(CHANGES)
def test_what_was_set_is_read_back(changes: dict[str, int]) -> None:
    last = with_changes(Biases(), changes)
    assert biases_of(at(**changes), CAMERA, last) == last


@given(CHANGES)
def test_parameters_that_nobody_set_by_biases_have_the_nearest(changes: dict[str, int]) -> None:
    """Found without knowing what was set, but for DiffBn: the currents are those, to the step of `fine`."""
    wanted, diff = at(**changes), {"DiffBn_fine": changes.get("DiffBn_fine", 39)}
    found = biases_of(wanted, CAMERA, with_changes(Biases(), diff))
    again = CAMERA.changed(changes_for(found, CAMERA))
    assert again.comparator.theta_on == pytest.approx(wanted.comparator.theta_on, rel=0.01)
    assert again.refractory_period.period_us == pytest.approx(wanted.refractory_period.period_us, rel=0.02)
    cutoff_hz = wanted.photoreceptor_bandwidth.cutoff_hz
    if cutoff_hz > 2:  # below, the smallest current is too much
        assert again.photoreceptor_bandwidth.cutoff_hz == pytest.approx(cutoff_hz, rel=0.02)


def test_an_effect_that_a_camera_is_without_stays_off() -> None:
    paper = Parameters.of("paper")
    changed = paper.changed(changes_for(with_changes(Biases(), {"PrBp_fine": 9, "RefrBp_fine": 9}), paper))
    assert changed == paper
    last = with_changes(Biases(), {"PrBp_fine": 9, "RefrBp_fine": 9})
    assert biases_of(paper, paper, last) == last


def test_a_number_may_be_written_with_a_point() -> None:
    assert with_changes(Biases(), {"ONBn_fine": 90.0}) == with_changes(Biases(), {"ONBn_fine": 90})


def test_names_are_those_of_the_drivers() -> None:
    assert list(Biases.model_fields) == [f"{name}_{part}" for name in USUAL for part in ("coarse", "fine")]
    assert all(field.description for field in Biases.model_fields.values())
