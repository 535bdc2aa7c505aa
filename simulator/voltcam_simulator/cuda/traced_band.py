"""What the effects do to a pixel, noted down: which kernels run over which planes, with which numbers.

An effect knows a band of pixels and hands kernels to `Band.apply`. Here the band is one that has names
instead of planes, and remembers. From that, `program` writes the function that a thread runs for its pixel.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..effect import Band, Effect, Plane, Sensor, State, overrides
from ..groups import Place
from ..plane_kernels import add_independent, copy


@dataclass(frozen=True, slots=True)
class Name:
    """How the function of a thread names one of its planes, of one pixel."""

    text: str


def named(text: str) -> Any:
    """A `Name` in the place of a plane."""
    return Name(text)


COPIES = 2
"""Planes of a step that effects may copy."""


@dataclass(kw_only=True)
class TracedBand(Band):
    """The whole sensor as one band of named planes, which notes what is applied to it."""

    calls: list[tuple[Callable[..., None], tuple[str, ...]]] = field(default_factory=list)
    """Each kernel, and what it is given, in the words of the function to be written."""
    tables: list[np.ndarray[Any, Any]] = field(default_factory=list)
    """Arrays that it is given beside planes."""
    numbers: list[Any] = field(default_factory=list)
    copies: int = 0

    @property
    def place(self) -> Place:
        height, width = self.sensor.height, self.sensor.width
        return WholePlace(0, 0, height, width)

    def apply(self, kernel: Callable[..., None], *arguments: Any) -> None:
        self.calls.append((kernel, tuple(self._told(argument) for argument in arguments)))

    def copied(self, plane: Plane) -> Plane:
        assert self.copies < COPIES
        own: Plane = named(f"band.copies[{self.copies}]")
        self.copies += 1
        self.apply(copy, plane, own)
        return own

    def independent_noise(self) -> Plane:
        noise2: Plane = named("band.noise2")
        self.noise2 = noise2
        return noise2

    def _told(self, argument: Any) -> str:
        if isinstance(argument, Name):
            return argument.text
        if isinstance(argument, WholePlace):
            return "place"
        if isinstance(argument, np.ndarray):
            self.tables.append(argument)
            return f"tables[{len(self.tables) - 1}]"
        self.numbers.append(argument)
        return f"numbers[{len(self.numbers) - 1}]"


class WholePlace(Place):
    """That of the whole sensor; a thread has that of its pixel instead."""


def traced(
    sensor: Sensor, states: dict[str, State], start_us: int, span_us: float, elapsed_us: float
) -> TracedBand:
    """A band without anything noted; states: the effects', with names for their planes."""
    light_before, light, response, drift, noise, bow, rate = (
        named(f"band.{plane}")
        for plane in ("light_before", "light", "response", "drift", "noise", "bow", "rate")
    )
    return TracedBand(
        sensor, 0, start_us, span_us, elapsed_us, sensor.temperature_c, light_before, light, response, drift,
        noise, bow, rate, leak=None if sensor.leak is None else named("band.leak"), planes=states,
    )  # fmt: skip


def see(band: TracedBand, effects: list[Effect]) -> None:
    """Note what makes light and response."""
    for effect in effects:
        if overrides(effect, "see"):
            effect.see(band)
    for effect in effects:
        if overrides(effect, "respond"):
            effect.respond(band)


def add_drift(band: TracedBand, effects: list[Effect]) -> None:
    """Note what makes drift and noise; kicks are in the band."""
    band.temperature_c = band.sensor.temperature_c
    for effect in effects:
        if overrides(effect, "drift"):
            effect.drift(band)
    if band.noise2 is not None:
        band.apply(add_independent, band.noise, band.noise2)
