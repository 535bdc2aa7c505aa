"""The ESIM pixel (Rebecq, Gehrig, Scaramuzza, CoRL 2018), which Vid2E (Gehrig et al., CVPR 2020) shares.

Log intensity ln(eps + I/255) goes in a straight line from frame to frame; an event comes each time it has
moved by C+ or C- from the level that the pixel remembers, and the remembered level moves by that C. In the
refractory period the level moves on, but no event comes out. Thresholds are Gaussian, clipped at 0.01.

One deviation: ESIM's own program draws C anew for each pixel at each frame. A level that the signal has
passed by then never fires, so with dense frames pixels fall silent; here each pixel draws its two C once.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from voltcam_simulator.event_key import event_address, event_key
from voltcam_simulator.kernel import kernel
from voltcam_simulator.random import pattern

from .frame_pixels import FramePixels, Keys, Plane, mismatched


@dataclass(frozen=True)
class EsimParameters:
    """The defaults of ESIM's own program."""

    theta_on: float = 1.0  # C+ [ln units]
    theta_off: float = 1.0
    theta_sigma: float = 0.021  # of both, over pixels
    refractory_period_us: float = 100.0
    log_eps: float = 0.001


class Esim(FramePixels):
    """width x height ESIM pixels."""

    def __init__(
        self, width: int, height: int, parameters: EsimParameters | None = None, seed: int = 0
    ) -> None:
        super().__init__(width, height)
        self.parameters = own = parameters or EsimParameters()
        generator = pattern(seed, "esim")
        self._theta_on = mismatched(generator, own.theta_on, own.theta_sigma, width * height)
        self._theta_off = mismatched(generator, own.theta_off, own.theta_sigma, width * height)
        self._last_us = np.full(width * height, -np.inf)

    def _settle(self, light: Plane) -> None:
        self._level = self._logarithm(light)
        self._memory = self._level.copy()

    def _step(self, light: Plane, start_us: int, span_us: int) -> Keys:
        before, self._level = self._level, self._logarithm(light)
        way = self._level - self._memory
        most = np.maximum(way / self._theta_on, -way / self._theta_off) + 1e-6  # against rounding
        keys = np.empty(int(np.floor(most).sum()), np.uint64)
        written = _cross(
            before, self._level, self._memory, self._theta_on, self._theta_off, self._last_us,
            float(start_us), float(span_us), self.parameters.refractory_period_us, self.width, keys,
        )  # fmt: skip
        return keys[:written]

    def _logarithm(self, light: Plane) -> Plane:
        return np.log(self.parameters.log_eps + light / 255.0)


@kernel
def _cross(
    before: Any, after: Any, memory: Any, theta_on: Any, theta_off: Any, last: Any,
    start: Any, span: Any, refractory: Any, width: Any, keys: Any,
) -> Any:  # fmt: skip
    """All pixels over one interval; memory and last are updated, keys filled. Returns how many."""
    written = 0
    for i in range(after.shape[0]):
        change = after[i] - before[i]
        if change == 0.0:
            continue
        side = 1.0 if change > 0.0 else -1.0
        theta = theta_on[i] if change > 0.0 else theta_off[i]
        while (after[i] - (memory[i] + side * theta)) * side >= 0.0:
            memory[i] += side * theta
            time = (memory[i] - before[i]) / change * span
            if start + time - last[i] >= refractory:
                last[i] = start + time
                keys[written] = event_key(time, event_address(i, width, 1.0 / width), side)
                written += 1
    return written
