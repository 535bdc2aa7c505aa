"""The fixed pattern of a sensor: what its effects lay down once for each set of parameters."""

from dataclasses import dataclass

import numpy as np

from .effect import Effect, Sensor
from .law import Law
from .parameters import Parameters


@dataclass(frozen=True, slots=True, eq=False)
class FixedPattern:
    """Parameters, the effects that are on, and the fixed pattern that these have laid down on the sensor."""

    parameters: Parameters
    effects: list[Effect]
    sensor: Sensor


def lay_down(
    width: int, height: int, seed: int, law: Law, parameters: Parameters, set_us: dict[str, float]
) -> FixedPattern:
    """The fixed pattern for parameters; set_us as in `Sensor`."""
    theta_on, theta_off = np.ones((2, height, width), np.float32)
    dark_level_dn = parameters.contrast_response.k2_dn
    sensor = Sensor(
        width, height, seed, parameters.temperature_c, dark_level_dn, theta_on, theta_off,
        set_us=set_us,
    )  # fmt: skip
    effects = [_by_law(law, effect) for effect in parameters.effects() if effect.active]
    for effect in effects:
        effect.prepare(sensor)
    return FixedPattern(parameters, effects, sensor)


def _by_law(law: Law, effect: Effect) -> Effect:
    """The paper's law is defined with the linearised response."""
    if law == "paper" and effect.name == "contrast_response":
        return effect.model_copy(update={"response": "linearised"})
    return effect
