"""Generic terms, one for each kind of what tells real events from simulated ones: formula and numbers."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from voltcam_simulator import Parameters

from ...dependence.covariates import Kind

DIGITS = 4


@dataclass(frozen=True)
class Shape(ABC):
    """A generic term: `fixed` numbers, and those that a fit may move, `numbers`; most: their limits."""

    kind: Kind
    effect: str
    fixed: Mapping[str, float]
    numbers: Mapping[str, float]
    most: ClassVar[Mapping[str, float]] = {"chance": 1.0, "size": 2.0, "delay_us": 1e6}

    def with_number(self, name: str, value: float) -> Self:
        """The same with one number as said, within its limit."""
        return replace(self, numbers={**self.numbers, name: min(value, self.most.get(name, np.inf))})

    def moves(self, name: str, factor: float) -> tuple[Self, Self]:
        """The same with a number larger, and smaller."""
        value = self.numbers[name]
        return self.with_number(name, value * factor), self.with_number(name, value / factor)

    def values(self) -> dict[str, float]:
        """Of the effect's parameters."""
        found = self._values({**self.fixed, **self.numbers})
        return {name: float(f"{value:.{DIGITS}g}") for name, value in found.items()}

    def on(self, parameters: Parameters) -> Parameters:
        """The parameters with the term."""
        return parameters.changed({self.effect: self.values()})

    @abstractmethod
    def formula(self) -> str:
        """For people."""

    @abstractmethod
    def _values(self, numbers: dict[str, float]) -> dict[str, float]:
        """The effect's parameters from these numbers."""


@dataclass(frozen=True)
class KickShape(Shape):
    """A kick some time after an event, of its own pixel or of a neighbour; signs: of those after an ON and
    after an OFF event."""

    signs: tuple[int, int] = (1, -1)

    def formula(self) -> str:
        """For people."""
        v = self.values()
        whose = "a neighbour's" if self.kind == "neighbours" else "the pixel's own"
        after = " and ".join(
            f"{v[name]:+.3g} after {whose} {sign} event"
            for name, sign in (("after_on", "ON"), ("after_off", "OFF"))
            if v[name]
        )
        spread = f" (times or over {10 ** v['spread_decades']:.2g})" if v["spread_decades"] else ""
        chance = f", with chance {v['chance']:.2g}" if v["chance"] < 1 else ""
        return f"V += {after}, {v['delay_us'] / 1000:.3g} ms later{spread}{chance}"

    def _values(self, numbers: dict[str, float]) -> dict[str, float]:
        size = numbers.pop("size")
        return {"after_on": self.signs[0] * size, "after_off": self.signs[1] * size, **numbers}


@dataclass(frozen=True)
class PatternShape(Shape):
    """A wave over the pixels' thresholds; signs: of their rise on its crest, for ON and for OFF."""

    signs: tuple[int, int] = (1, 1)
    most: ClassVar[Mapping[str, float]] = {"size": 0.9}

    def moves(self, name: str, factor: float) -> tuple[Self, Self]:
        """The crest is moved by a part of the wave."""
        if name != "crest_turns":
            return super().moves(name, factor)
        part, crest = (factor - 1) / 8, self.numbers[name]
        return self.with_number(name, (crest + part) % 1.0), self.with_number(name, (crest - part) % 1.0)

    def formula(self) -> str:
        """For people."""
        v = self.values()
        thresholds = " and ".join(
            f"{sign} thresholds *= 1 {v[name]:+.2g} w"
            for name, sign in (("on", "ON"), ("off", "OFF"))
            if v[name]
        )
        along = " ".join(
            f"{v[name]:+.3g} {axis}"
            for name, axis in (("across_per_px", "x"), ("down_per_px", "y"))
            if v[name]
        )
        return f"{thresholds}, w = cos 2 pi ({along} - {v['crest_turns']:.2g})"

    def _values(self, numbers: dict[str, float]) -> dict[str, float]:
        size = numbers.pop("size")
        return {"on": self.signs[0] * size, "off": self.signs[1] * size, **numbers}


@dataclass(frozen=True)
class ClockShape(Shape):
    """A kick up at one phase of a clock and down half a period later."""

    def moves(self, name: str, factor: float) -> tuple[Self, Self]:
        """A time is moved by a part of the period."""
        if name != "begin_us":
            return super().moves(name, factor)
        part = (factor - 1) * self.fixed["period_us"] / 8
        begin = self.numbers[name]
        return self.with_number(name, begin + part), self.with_number(name, begin - part)

    def formula(self) -> str:
        """For people."""
        v = self.values()
        row = f" + {v['row_us']:.3g} us a row" if v["row_us"] else ""
        return (
            f"V += {v['kick']:.3g} in the first half of each period of {v['period_us'] / 1000:.4g} ms"
            f" from {v['begin_us'] / 1000:.3g} ms{row} on"
        )

    def _values(self, numbers: dict[str, float]) -> dict[str, float]:
        return {"kick": numbers.pop("size"), **numbers}
