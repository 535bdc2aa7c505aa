"""What effects lay down on a sensor for a set of parameters."""

import numpy as np

from voltcam_simulator import Law, Parameters
from voltcam_simulator.fixed_pattern import FixedPattern, lay_down

from .scenes import only


def laid(parameters: Parameters, law: Law = "exact", seed: int = 1) -> FixedPattern:
    return lay_down(7, 5, seed, law, parameters, {"comparator": 12.0})


def test_the_sensor_has_the_size_and_what_is_common_to_effects() -> None:
    parameters = only(contrast_response={"k1": 1, "k2_dn": 33}).changed({"temperature_c": 40})
    sensor = laid(parameters).sensor
    assert (sensor.width, sensor.height, sensor.seed) == (7, 5, 1)
    assert (sensor.temperature_c, sensor.dark_level_dn) == (40, 33)
    assert sensor.theta_on.shape == sensor.theta_off.shape == (5, 7)
    assert sensor.set_us == {"comparator": 12.0}
    assert sensor.leak is None


def test_only_active_effects_are_in_it_in_the_order_of_the_registry() -> None:
    effects = laid(only(readout={"row_us": 3}, junction_leak={"k4_per_us": 1e-7})).effects
    assert [effect.name for effect in effects] == ["junction_leak", "comparator", "readout"]


def test_each_effect_lays_down_its_part() -> None:
    sensor = laid(
        only(
            comparator={"theta_on": 2.0, "theta_off": 0.5},
            refractory_period={"period_us": 300},
            reset_noise={"sigma": 0.1},
            leak_mismatch={"sigma": 0.5},
        )
    ).sensor
    assert (sensor.theta_on == 2).all()
    assert (sensor.theta_off == 0.5).all()
    assert (sensor.refractory_us, sensor.reset_sigma) == (300, 0.1)
    assert sensor.leak is not None
    assert sensor.leak.std() > 0


def test_it_is_repeatable_by_seed_and_one_effect_does_not_move_another_s() -> None:
    mismatch = only(threshold_mismatch={"sigma": 0.1})
    first = laid(mismatch).sensor.theta_on
    np.testing.assert_array_equal(laid(mismatch).sensor.theta_on, first)
    np.testing.assert_array_equal(
        laid(mismatch.changed({"leak_mismatch": {"sigma": 0.5}})).sensor.theta_on, first
    )
    assert (laid(mismatch, seed=2).sensor.theta_on != first).any()


def test_the_paper_s_law_has_the_linearised_response_and_parameters_stay_as_given() -> None:
    parameters = Parameters()
    assert parameters.contrast_response.response == "logarithmic"
    for law, response in (("exact", "logarithmic"), ("paper", "linearised")):
        pattern = laid(parameters, law=law)  # type: ignore[arg-type]
        by_name = {effect.name: effect for effect in pattern.effects}
        assert by_name["contrast_response"].model_dump()["response"] == response
        assert pattern.parameters is parameters
