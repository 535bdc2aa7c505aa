"""One model of all parameters, built from the registry of effects."""

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Self

from pydantic import BaseModel, ConfigDict, Field, create_model, field_validator

from .camera_file import SensorSize, divided, read
from .effect import Effect, no_truth, quantity
from .effects import EFFECTS

MOST_GAMMA = 11.0  # the limit of the parameter, beyond which a recording could not be made again


class ParameterSet(BaseModel):
    """What is common to any set of effects; use `Parameters`, which has a field for each registered one."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    _numbers = field_validator("temperature_c", mode="before")(no_truth)

    temperature_c: float = quantity(
        25.0, unit="C", ge=-40, le=125, meaning="temperature of the sensor die", source="room temperature"
    )

    @classmethod
    def of(cls, camera: str) -> Self:
        """The parameters of a named camera ("davis346") or of a camera file (path to YAML).

        Raises the same as `Camera.load`.
        """
        size, content = divided(read(camera))
        parameters = cls.model_validate(content)
        SensorSize(**size)
        return parameters

    def effects(self) -> Iterator[Effect]:
        """The effects with these parameters, in registry order."""
        for effect in EFFECTS:
            yield getattr(self, effect.name)

    @property
    def longest_step_us(self) -> float:
        """The longest step that all active effects allow; inf: any."""
        return min((effect.longest_step_us for effect in self.effects() if effect.active), default=math.inf)

    def changed(self, changes: Mapping[str, Any]) -> Self:
        """A copy with some parameters changed, {"comparator": {"theta_on": 1.2}, "temperature_c": 40}.

        Raises pydantic.ValidationError, naming each unknown key and each value out of its limits.
        """
        return type(self).model_validate(merged(self.model_dump(), changes))

    def seen_through(self, gamma: float) -> Self:
        """Of a sensor that is shown grey levels of which light is the power `gamma`, up to MOST_GAMMA with
        the camera's own exponent."""
        if gamma == 1:
            return self
        own: float = self.input_response.gamma_exponent  # type: ignore[attr-defined]
        return self.changed({"input_response": {"gamma_exponent": min(gamma * own, MOST_GAMMA)}})

    def changes_since(self, before: Self) -> dict[str, Any]:
        """The changes that make these parameters of those before, as `changed` takes them."""
        was, changes = before.model_dump(), {}
        for name, value in self.model_dump().items():
            if value != was[name]:
                nested = isinstance(value, dict)
                changes[name] = (
                    {key: one for key, one in value.items() if one != was[name][key]} if nested else value
                )
        return changes


def merged(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """base with changes laid over it, nested mappings key by key."""
    result = dict(base)
    for key, value in changes.items():
        former = result.get(key)
        both = isinstance(former, Mapping) and isinstance(value, Mapping)
        result[key] = merged(former, value) if both else value  # type: ignore[arg-type]
    return result


if TYPE_CHECKING:

    class Parameters(ParameterSet):
        """All parameters of a camera: temperature_c, and a field for each effect."""

        def __getattr__(self, name: str) -> Any: ...

else:
    Parameters = create_model(
        "Parameters",
        __base__=ParameterSet,
        __doc__="All parameters of a camera: temperature_c, and a field for each effect.",
        **{
            effect.name: (
                effect,
                Field(default_factory=effect, description=effect.__doc__.partition("\n")[0]),
            )
            for effect in EFFECTS
        },
    )
