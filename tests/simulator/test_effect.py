"""What every effect has from its base: a name, parameters that refuse nonsense, stages that do nothing."""

from typing import ClassVar

import numpy as np
import pytest
from pydantic import ValidationError

from voltcam_simulator import EVENT, Limits
from voltcam_simulator.effect import About, Band, Effect, EventInterval, Events, Sensor, overrides, quantity
from voltcam_simulator.limits import TooLongError, TooManyEventsError


class SlowFade2D(Effect):
    """An effect of this file's."""

    about: ClassVar[About] = "light"
    signature: ClassVar[str] = "none"

    depth: float = quantity(0.0, unit="1", ge=0, le=1, meaning="how deep", source="this file")

    @property
    def active(self) -> bool:
        return self.depth > 0

    def see(self, band: Band) -> None:
        band.light *= np.float32(1 - self.depth)


def sensor(seed: int = 1) -> Sensor:
    ones = np.ones((2, 3), np.float32)
    return Sensor(3, 2, seed, 25.0, 20.0, ones, ones.copy())


def band() -> Band:
    planes = (np.full(6, level, np.float32) for level in (10, 20, 0, 0, 3, 0, 0))
    return Band(sensor(), 0, 1000, 250.0, 0.0, 25.0, *planes)


def interval(number: int = 0, limits: Limits | None = None) -> EventInterval:
    plane = np.zeros(6, np.float32)
    return EventInterval(sensor(), 1000, 1600, number, {}, plane, plane, limits or Limits())


def test_the_name_is_the_class_s_in_snake_case() -> None:
    assert SlowFade2D.name == "slow_fade2_d"


@pytest.mark.parametrize("depth", [True, "deep", -0.1, 1.1, float("nan"), None])
def test_a_parameter_is_a_number_in_its_limits(depth: object) -> None:
    with pytest.raises(ValidationError, match="depth"):
        SlowFade2D.model_validate({"depth": depth})


def test_an_effect_is_frozen_and_knows_its_parameters() -> None:
    effect = SlowFade2D(depth=0.5)
    with pytest.raises(ValidationError, match="frozen"):
        effect.depth = 0.6
    with pytest.raises(ValidationError, match="width"):
        SlowFade2D.model_validate({"width": 1})


def test_the_schema_tells_unit_source_limits_and_whether_it_is_off() -> None:
    schema = SlowFade2D.model_json_schema()
    assert (schema["about"], schema["off_by_default"]) == ("light", True)
    depth = schema["properties"]["depth"]
    assert (depth["unit"], depth["source"], depth["description"]) == ("1", "this file", "how deep")
    assert (depth["minimum"], depth["maximum"], depth["default"]) == (0, 1, 0)


def test_only_what_a_class_overrides_is_called() -> None:
    acting = [s for s in ("prepare", "see", "respond", "drift", "report") if overrides(SlowFade2D(), s)]
    assert acting == ["see"]


def test_a_stage_that_is_not_overridden_changes_nothing() -> None:
    effect, before, here = SlowFade2D(), band(), band()
    effect.prepare(here.sensor)
    effect.respond(here)
    effect.drift(here)
    for plane in ("light", "response", "drift", "noise"):
        np.testing.assert_array_equal(getattr(here, plane), getattr(before, plane))
    events = np.zeros(2, EVENT)
    assert effect.report(events, interval()) is events
    assert effect.state(here.sensor) == {}
    assert (effect.longest_step_us, effect.earliest_us, effect.stamp_us(7)) == (np.inf, 0, 7)


def test_a_pattern_is_repeatable_and_each_effect_s_own() -> None:
    def drawn(seed: int, name: str) -> list[float]:
        return sensor(seed).pattern(name).random(4).tolist()

    assert drawn(1, "a") == drawn(1, "a")
    assert len({tuple(drawn(seed, name)) for seed in (1, 2) for name in ("a", "b")}) == 4


def test_a_step_ends_its_span_after_its_start() -> None:
    assert band().end_us == 1250
    assert interval().span_us == 600


def test_independent_noise_is_made_once_and_kept() -> None:
    here = band()
    assert here.noise2 is None
    here.independent_noise()[2] += 5
    assert here.independent_noise().tolist() == [0, 0, 5, 0, 0, 0]
    assert here.independent_noise() is here.noise2


def test_an_interval_has_numbers_of_its_own_for_each_effect() -> None:
    firsts = {(n, name): interval(n).generator(name).random() for n in (0, 1) for name in ("a", "b")}
    keys = {interval(n).key(name) for n in (0, 1) for name in ("a", "b")}
    assert len(set(firsts.values())) == len(keys) == 4
    assert interval(1).generator("b").random() == firsts[1, "b"]
    assert interval(1).key("b") in keys


@pytest.mark.parametrize("count", [0, 3, 12, 1000])
def test_an_effect_has_room_for_all_its_events_however_many_are_expected(count: int) -> None:
    def fill(events: Events) -> int:
        events["x"] = np.arange(len(events))
        return count

    events = interval().filled(4.0, fill)
    assert events["x"].tolist() == list(range(count))


def test_no_space_is_taken_beyond_the_limits() -> None:
    interval(limits=Limits(most_events=5)).admit(5)
    with pytest.raises(TooManyEventsError):
        interval(limits=Limits(most_events=5)).admit(5.5)
    with pytest.raises(TooLongError):
        interval(limits=Limits(late=lambda: True)).admit(1)
