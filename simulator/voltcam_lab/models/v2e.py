"""The v2e pixel (Hu, Liu, Delbruck, CVPRW 2021; constants as in its authors' program).

Light goes through a lin-log map (straight below 20 DN, logarithm above) and a first-order low pass whose
cutoff is proportional to intensity; leak lowers the remembered level; then the pixel gives out
floor(|difference|/threshold) events, and remembers that many thresholds more. The k-th of them comes at k/n
of the frame interval, n being the most that any pixel gives out in it. Shot noise is drawn per pixel and
frame, at a rate that falls with brightness; its events come at the frame's end, and the pixel then remembers
the light of that moment.

From earlier versions of that program: the remembered level starts a random part of a threshold down, since
otherwise there is no leak event in the first ten seconds (at 0.1 Hz) and then one of each pixel.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from voltcam_simulator.event_key import event_address, event_key
from voltcam_simulator.kernel import kernel
from voltcam_simulator.random import events_key, normal, pattern, sequence, uniform

from .frame_pixels import FramePixels, Keys, Plane, mismatched

LINEAR_BELOW_DN = 20.0
BRIGHT_NOISE_FACTOR = 0.25
"""Shot noise at full brightness, as a part of that in the dark."""


@dataclass(frozen=True)
class V2eParameters:
    """The defaults of the program's emulator class."""

    theta_on: float = 0.2  # [ln units]
    theta_off: float = 0.2
    theta_sigma: float = 0.03  # of both, over pixels
    cutoff_hz: float = 0.0  # at full brightness; 0: no low pass
    leak_rate_hz: float = 0.1
    leak_jitter: float = 0.1  # of the leak in a frame, relative
    leak_mismatch_decades: float = 0.1  # over pixels, log-normal
    shot_noise_rate_hz: float = 0.0  # in the dark, both polarities together
    refractory_period_us: float = 0.0

    @classmethod
    def clean(cls) -> "V2eParameters":
        """The program's preset for low noise: thresholds only."""
        return cls(theta_sigma=0.02, leak_rate_hz=0.0, leak_jitter=0.0, leak_mismatch_decades=0.0)

    @classmethod
    def noisy(cls) -> "V2eParameters":
        """The program's preset for low light."""
        return cls(theta_sigma=0.05, cutoff_hz=30.0, shot_noise_rate_hz=5.0)


class V2e(FramePixels):
    """width x height v2e pixels."""

    def __init__(
        self, width: int, height: int, parameters: V2eParameters | None = None, seed: int = 0
    ) -> None:
        super().__init__(width, height)
        self.parameters = own = parameters or V2eParameters()
        self._seed, self._frames = seed, 0
        generator, pixels = pattern(seed, "v2e"), width * height
        self._theta_on = mismatched(generator, own.theta_on, own.theta_sigma, pixels)
        self._theta_off = mismatched(generator, own.theta_off, own.theta_sigma, pixels)
        self._leak = own.leak_rate_hz * 10.0 ** generator.normal(0.0, own.leak_mismatch_decades, pixels)
        self._start = generator.uniform(0.0, 1.0, pixels)
        self._last_us = np.full(pixels, -np.inf)

    def _settle(self, light: Plane) -> None:
        self._photo = lin_log(light)
        self._memory = self._photo.copy()
        if self.parameters.leak_rate_hz > 0:
            self._memory -= self._start * self._theta_on

    def _step(self, light: Plane, start_us: int, span_us: int) -> Keys:
        own, span_s = self.parameters, span_us * 1e-6
        intensity = relative_intensity(light)
        if own.cutoff_hz > 0:
            share = np.minimum(2.0 * math.pi * own.cutoff_hz * intensity * span_s, 1.0)
            self._photo += share * (lin_log(light) - self._photo)
        else:
            self._photo = lin_log(light)
        key = events_key(self._seed, "v2e", self._frames)
        self._frames += 1
        if own.leak_rate_hz > 0:
            _leak(key, self._leak * span_s, own.leak_jitter, self._theta_on, self._memory)
        difference = self._photo - self._memory
        theta = np.where(difference > 0, self._theta_on, -self._theta_off)
        counts = np.floor(difference / theta).astype(np.int64)
        most = max(int(counts.max()), 1)
        noise = 0.5 * own.shot_noise_rate_hz * span_s * (1.0 - (1.0 - BRIGHT_NOISE_FACTOR) * intensity)
        keys = np.empty(int(counts.sum()) + np.count_nonzero(noise), np.uint64)
        written = _signal(
            counts, theta, self._memory, self._last_us,
            float(start_us), span_us, most, own.refractory_period_us, self.width, keys,
        )  # fmt: skip
        if own.shot_noise_rate_hz > 0:
            chance_on = noise * own.theta_on / self._theta_on
            chance_off = noise * own.theta_off / self._theta_off
            written += _noise(
                key, chance_on, chance_off, self._photo, self._memory, span_us, self.width, keys[written:]
            )
        return keys[:written]


def lin_log(light: Plane) -> Plane:
    """Straight from 0 to ln 20 at 20 DN, the logarithm above."""
    steep = math.log(LINEAR_BELOW_DN) / LINEAR_BELOW_DN
    return np.where(light <= LINEAR_BELOW_DN, light * steep, np.log(np.maximum(light, LINEAR_BELOW_DN)))


def relative_intensity(light: Plane) -> Plane:
    """What cutoff and shot noise go by: 1 at 255 DN, with an offset that keeps dark pixels going."""
    return (light + 20.0) / 275.0


@kernel
def _leak(key: Any, thresholds: Any, jitter: Any, theta_on: Any, memory: Any) -> None:
    """The remembered level sinks by a part of each pixel's own ON threshold, so that the rate is the same."""
    for i in range(memory.shape[0]):
        _, z = normal(sequence(key, i))
        memory[i] -= thresholds[i] * (1.0 - jitter * z) * theta_on[i]


@kernel
def _signal(
    counts: Any, theta: Any, memory: Any, last: Any,
    start: Any, span: Any, most: Any, refractory: Any, width: Any, keys: Any,
) -> Any:  # fmt: skip
    """theta: (pixels,) the threshold in the direction of each pixel's events, negative for OFF."""
    written = 0
    for i in range(counts.shape[0]):
        for event in range(1, counts[i] + 1):
            time = event * span / most
            if start + time - last[i] >= refractory:
                last[i] = start + time
                memory[i] += theta[i]
                keys[written] = event_key(time, event_address(i, width, 1.0 / width), theta[i])
                written += 1
    return written


@kernel
def _noise(
    key: Any, chance_on: Any, chance_off: Any, photo: Any, memory: Any, span: Any, width: Any, keys: Any
) -> Any:  # fmt: skip
    written = 0
    for i in range(memory.shape[0]):
        _, u = uniform(~sequence(key, i))  # not the sequence of the leak's jitter
        on, off = u > 1.0 - chance_on[i], u < chance_off[i]
        if on or off:
            memory[i] = photo[i]
            keys[written] = event_key(span, event_address(i, width, 1.0 / width), 1.0 if on else -1.0)
            written += 1
    return written
