"""Coordinates of the search and the camera that they stand for."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.lab.calibration.refine.made import START

from voltcam_lab.calibration.refine.coordinates import (
    ABSENT,
    CORE,
    DARKEST_TOLD_DN,
    OFFERED,
    parameters_at,
    point_of,
    response,
    with_curvature,
)
from voltcam_lab.light.grey import WHITE_DN
from voltcam_simulator import Parameters


def test_coordinates_are_the_camera() -> None:
    """Thresholds of any unit become those whose geometric mean is 1; the rest goes with them."""
    camera = START.changed({
        "comparator": {"theta_on": 3.0, "theta_off": 0.75},
        "input_response": {"gamma_exponent": 0.7},
        "reset_noise": {"sigma": 0.15},
    })  # fmt: skip
    found = parameters_at(point_of(camera), camera)
    assert found.comparator.theta_on == pytest.approx(2.0)
    assert found.comparator.theta_off == pytest.approx(0.5)
    assert found.contrast_response.k1 == pytest.approx(9.0 / 1.5)
    assert found.contrast_response.k2_dn == pytest.approx(20.0)
    assert found.reset_noise.sigma == pytest.approx(0.1)
    assert found.input_response.gamma_exponent == pytest.approx(0.7)


def test_a_camera_that_comes_back_is_the_same_in_every_coordinate() -> None:
    """Each mechanism at a size of its own."""
    point = point_of(START) | {name: sizes[0] for name, sizes in OFFERED}
    assert set(point) == {*CORE, *ABSENT, "delay_us"}
    again = point_of(parameters_at(point, START))
    assert again == pytest.approx(point)


def test_a_follower_needs_no_other_limit() -> None:
    """The effect has none without a cutoff: then there is one, out of reach, and it comes back."""
    camera = parameters_at(point_of(START) | {"follower_hz": 90.0}, START)
    assert camera.photoreceptor_bandwidth.active
    assert camera.photoreceptor_bandwidth.follower_hz == 90
    late_us = 1e6 / (2 * np.pi * camera.photoreceptor_bandwidth.cutoff_hz) * 275 / 20  # in the dark
    assert late_us < 100
    again = point_of(parameters_at(point_of(camera), camera))
    assert again == pytest.approx(point_of(camera))


def test_what_frames_do_is_seen_at_the_same_time_with_another_delay() -> None:
    camera = START.changed({"latency": {"delay_us": 1000.0}, "aps_coupling": {"offset_us": 700.0}})
    moved = parameters_at(point_of(camera) | {"delay_us": 1600.0}, camera)
    assert (moved.latency.delay_us, moved.aps_coupling.offset_us) == (1600.0, 100.0)


def test_what_may_be_absent_is_absent_in_a_plain_camera() -> None:
    point = point_of(Parameters.of("ideal"))
    assert {name: point[name] for name in ABSENT if name != "k6"} == {
        name: value for name, value in ABSENT.items() if name != "k6"
    }


@given(gamma=st.floats(0.3, 2.5), knee_dn=st.floats(2, 200))
def test_the_response_is_the_voltage_of_the_camera(gamma: float, knee_dn: float) -> None:
    """k1 ln(light + k2), light being 255 (grey / 255)^gamma."""
    camera = parameters_at(point_of(START) | {"gamma": gamma, "knee_dn": knee_dn}, START)
    grey = np.array([3.0, 40.0, 200.0])
    light = WHITE_DN * (grey / WHITE_DN) ** gamma
    voltage = camera.contrast_response.k1 * np.log(light + camera.contrast_response.k2_dn)
    unit = np.sqrt(camera.comparator.theta_on * camera.comparator.theta_off)
    assert response(point_of(camera), grey) == pytest.approx((voltage - voltage[0]) / unit)


@given(gamma=st.floats(0.4, 2.0), knee_dn=st.floats(3, 150))
def test_another_curvature_leaves_the_way_from_dark_to_bright(gamma: float, knee_dn: float) -> None:
    ends = np.array([DARKEST_TOLD_DN, WHITE_DN / 2])
    point = point_of(START)
    bent = with_curvature(point, gamma, knee_dn)
    assert response(bent, ends)[1] == pytest.approx(response(point, ends)[1])
    assert {name for name in point if bent[name] != point[name]} <= {"gamma", "knee_dn", "gain"}


def test_no_camera_beyond_the_limits() -> None:
    with pytest.raises(ValueError, match="gamma_exponent"):
        parameters_at(point_of(START) | {"gamma": 99.0}, START)
