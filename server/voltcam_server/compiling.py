"""Kernels compiled before they are needed, so that no frame need wait seconds for them."""

from contextlib import suppress

import numpy as np

from voltcam_simulator import Device, GivenUpError, Law, Limits, Parameters, Simulator
from voltcam_simulator.effect import Effect

SPANS_US, MOST_EVENTS = (10_000, 10, 1), 10_000
"""The interval that is tried, shorter where it has too many events."""
IN_NO_ORDER = {"latency": {"delay_us": 5000, "jitter_us": 1000}}
"""What has events sorted, and merged with those that wait: how that is done depends on the light, too..."""
THETAS = 0.01, 0.5
"""...namely on how many there are; these have many and few."""
Kind = tuple[str, ...]


class CompiledEffects:
    """What has been compiled for one law and device."""

    def __init__(self, law: Law, device: Device = "cpu") -> None:
        self._law: Law = law
        self._device: Device = device
        self._kinds: frozenset[Kind] = frozenset()

    def prepare(self, parameters: Parameters) -> None:
        """Have compiled what these parameters need.

        What an effect needs depends on which others are on; so what differs from the last in kind is tried
        anew, which takes some 10 ms where all has been compiled.
        """
        kinds = frozenset(_kind(effect) for effect in parameters.effects() if effect.active)
        if kinds == self._kinds:
            return
        if not self._kinds:
            for theta in THETAS:
                comparator = {"theta_on": theta, "theta_off": theta}
                self._try(Parameters().changed(IN_NO_ORDER | {"comparator": comparator}))
        self._try(parameters)
        self._kinds = kinds

    def _try(self, parameters: Parameters) -> None:
        for span_us in SPANS_US:
            small = Simulator(2, 2, parameters, self._law, device=self._device)
            small.advance(np.zeros((2, 2), np.uint8), 0)
            steps = span_us / parameters.longest_step_us
            limits = Limits(max(1.0, steps / 4), MOST_EVENTS)
            with suppress(GivenUpError):
                small.advance(np.full((2, 2), 255, np.uint8), span_us, limits)
                small.advance(np.full((2, 2), 1, np.float32), 2 * span_us, limits)
                return


def _kind(effect: Effect) -> Kind:
    """What decides which kernels an effect needs: its name, its ways, and which of its quantities are 0."""
    values = effect.model_dump().items()
    return effect.name, *(value if isinstance(value, str) else name for name, value in values if value)
