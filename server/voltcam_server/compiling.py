"""Kernels compiled before they are needed, so that no frame need wait seconds for them."""

from contextlib import suppress

import numpy as np

from voltcam_simulator import Device, GivenUpError, Law, Limits, Parameters, Simulator
from voltcam_simulator.effect import Effect

SPANS_US, MOST_EVENTS = (10_000, 10, 1), 10_000
"""The interval that is tried, shorter where it has too many events."""


class CompiledEffects:
    """Which effects have been compiled for one law and device."""

    def __init__(self, law: Law, device: Device = "cpu") -> None:
        self._law: Law = law
        self._device: Device = device
        self._kinds: set[tuple[str, ...]] = set()

    def prepare(self, parameters: Parameters) -> None:
        """Have compiled what these parameters need."""
        kinds = {_kind(effect) for effect in parameters.effects() if effect.active}
        if kinds <= self._kinds:
            return
        self._kinds |= kinds
        for span_us in SPANS_US:
            small = Simulator(2, 2, parameters, self._law, device=self._device)
            small.advance(np.zeros((2, 2), np.uint8), 0)
            steps = span_us / parameters.longest_step_us
            with suppress(GivenUpError):
                limits = Limits(max(1.0, steps / 4), MOST_EVENTS)
                small.advance(np.full((2, 2), 255, np.uint8), span_us, limits)
                return


def _kind(effect: Effect) -> tuple[str, ...]:
    """What decides which kernels an effect needs: its name and those of its ways."""
    return effect.name, *(value for value in effect.model_dump().values() if isinstance(value, str))
