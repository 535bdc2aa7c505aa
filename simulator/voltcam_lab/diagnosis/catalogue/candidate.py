"""A form of an effect that a diagnosis may add to a camera file, at sizes at which it may be there."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf, log, nextafter
from typing import Any, Literal

import numpy as np
from pydantic.fields import FieldInfo

from voltcam_simulator import Parameters

Growth = Literal["stronger", "weaker", "ratio"]
"""What a larger first size does. It makes the effect stronger; or weaker (a cutoff frequency, a largest
rate); or it is a ratio, 1 where there is no effect."""
Interval = tuple[float, float, float]
"""(value, low end, high end)."""


@dataclass(frozen=True)
class Candidate:
    """A form of an effect, and how to switch it on. Sizes are numbers for `names`, parameters of the effect.

    sizes: where the search looks. Fits find other sizes of the same sign. others: further parameters, fixed.
    least: smallest possible first number (a share of pixels is at least one pixel). growth: of the first
    number.
    """

    effect: str
    names: tuple[str, ...]
    sizes: tuple[tuple[float, ...], ...]
    others: Mapping[str, Any] = field(default_factory=dict)
    least: float = 0.0
    growth: Growth = "stronger"

    def scaled(self, size: tuple[float, ...], amount: float) -> tuple[float, ...]:
        """The size at which the effect is about `amount` times as strong."""
        if self.growth == "ratio":
            return (size[0] ** amount, *size[1:])
        return (size[0] / amount if self.growth == "weaker" else size[0] * amount, *size[1:])

    def weaker(self, one: float, other: float) -> float:
        """Of two first numbers, the one at which the effect is weaker."""
        if self.growth == "ratio":
            return min(one, other, key=lambda ratio: abs(np.log(ratio)))
        return max(one, other) if self.growth == "weaker" else min(one, other, key=abs)

    def times(self, size: tuple[float, ...]) -> float:
        """How many times as strong as the strongest of `sizes`."""
        here, there = size[0], [one[0] for one in self.sizes]
        if self.growth == "ratio":
            return min(log(here) / log(one) for one in there if log(one) * log(here) >= 0)
        return min(one / here if self.growth == "weaker" else here / one for one in there if one * here > 0)

    def possible(self, size: tuple[float, ...]) -> bool:
        """Whether the registry's limits allow the size: a fit of the wrong effect may end beyond them."""
        fields = type(getattr(Parameters(), self.effect)).model_fields
        limited = (
            (fields[name], value) for name, value in zip(self.names, size, strict=True) if name in fields
        )
        return abs(size[0]) >= self.least and all(_clipped(one, value) == value for one, value in limited)

    def on(self, parameters: Parameters, size: tuple[float, ...]) -> Parameters:
        """The parameters with the effect at a size (one number for each name)."""
        values = dict(zip(self.names, size, strict=True))
        return within_limits(parameters, {self.effect: {**self.others, **values}})

    def is_on(self, parameters: Parameters) -> bool:
        """Whether the parameters have already what the candidate would change."""
        effect = getattr(parameters, self.effect)
        if not effect.active:
            return False
        off = type(effect)()
        own = any(getattr(effect, name) != getattr(off, name) for name in self.names)
        return own or bool(self.others)

    def intervals(
        self, parameters: Parameters, log_half_widths: tuple[float, ...], origin_us: int = 0
    ) -> dict[str, Interval]:
        """Intervals of the effect's own parameters, by name.

        log_half_widths: of the logarithm of each size. origin_us: zero of the diagnosis' clock on the
        recording's, for parameters that depend on the clock.
        """
        effect = getattr(parameters, self.effect)
        pairs = zip(self.names, log_half_widths, strict=True)
        return {name: interval_about(getattr(effect, name), half) for name, half in pairs}


def interval_about(value: float, log_half_width: float) -> Interval:
    """The interval of a value whose logarithm is known to a half width."""
    low, high = sorted((value * float(np.exp(-log_half_width)), value * float(np.exp(log_half_width))))
    return value, low, high


def within_limits(parameters: Parameters, changes: Mapping[str, Mapping[str, Any]]) -> Parameters:
    """The parameters changed, numbers moved into the registry's limits: a fit knows of none."""
    return parameters.changed(
        {
            effect: {name: _allowed(fields[name], value) for name, value in values.items()}
            for effect, values in changes.items()
            for fields in [type(getattr(parameters, effect)).model_fields]
        }
    )


def _allowed(parameter: FieldInfo, value: Any) -> Any:
    value = _clipped(parameter, value)
    return round(value) if parameter.annotation is int else value


def _clipped(parameter: FieldInfo, value: Any) -> Any:
    for limit in parameter.metadata:
        value = max(value, getattr(limit, "ge", -inf), nextafter(getattr(limit, "gt", -inf), inf))
        value = min(value, getattr(limit, "le", inf))
    return value
