"""Parameters are declared once and refuse what is wrong."""

import math

import pytest
from pydantic import ValidationError

from voltcam_simulator import Parameters
from voltcam_simulator.effects import EFFECTS


def test_every_effect_is_there_under_its_name() -> None:
    assert [effect.name for effect in Parameters().effects()] == [effect.name for effect in EFFECTS]
    assert "contrast_response" in Parameters.model_json_schema()["properties"]


def test_every_parameter_says_what_it_is() -> None:
    for effect in EFFECTS:
        assert effect.signature
        assert effect.__doc__
        for name, schema in effect.model_json_schema()["properties"].items():
            assert schema["description"], (effect.name, name)
            if schema.get("type") == "number":
                assert {"unit", "source", "default", "maximum"} <= set(schema), (effect.name, name)
                assert "minimum" in schema or "exclusiveMinimum" in schema


def test_a_change_is_a_copy_and_keeps_the_rest() -> None:
    before = Parameters()
    after = before.changed({"comparator": {"theta_on": 1.5}, "temperature_c": 40})
    assert (before.comparator.theta_on, before.temperature_c) == (1.0, 25.0)
    assert (after.comparator.theta_on, after.comparator.theta_off, after.temperature_c) == (1.5, 1.0, 40.0)


@pytest.mark.parametrize(
    "changes",
    [
        {"comparator": {"theta_on": 0}},
        {"comparator": {"theta_on": math.nan}},
        {"comparator": {"theta_on": math.inf}},
        {"comparator": {"theta_on": "wide"}},
        {"comparator": {"theta": 1}},
        {"comparator": 3},
        {"comparators": {}},
        {"temperature_c": 1000},
        {"temperature_c": None},
        {"contrast_response": {"k2_dn": 0}},
        {"contrast_response": {"response": "cubic"}},
    ],
)
def test_wrong_changes_are_refused_by_name(changes: dict[str, object]) -> None:
    with pytest.raises(ValidationError, match=next(iter(changes))):
        Parameters().changed(changes)


@pytest.mark.parametrize(("own", "both"), [(1.0, 2.2), (0.5, 1.1), (11.0, 11.0)])
def test_a_code_comes_on_top_of_the_camera_s_own_up_to_the_limit(own: float, both: float) -> None:
    camera = Parameters().changed({"input_response": {"gamma_exponent": own}})
    seen = camera.seen_through(2.2)
    assert seen.input_response.gamma_exponent == pytest.approx(both)
    assert Parameters.model_validate(seen.model_dump()) == seen  # as a recording keeps it
