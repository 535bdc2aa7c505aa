"""The photoreceptor follows the light only so fast, and the slower the darker it is."""

import math
from typing import Any, ClassVar

import numpy as np

from ..effect import About, Band, Effect, Plane, Sensor, State, quantity
from ..kernel import kernel

STEP_IN_TIME_CONSTANTS = 8.0
"""Of the brightest pixels. Within a step the voltage is taken as a straight line. At a bend of the light by a
share q of its slope it is then off by what the light brings in at most q time constants, and at most 0.106 q
steps (the most an exponential leaves its chord, over all time constants; straight lines between frames miss
by q/8 already). Eight are 0.6 of a time constant at 0 DN: dim pixels, whose lag is what shows, are followed
closely."""
SHORT_US = 1000.0
"""No step need be shorter: 0.106 of it are 0.1 ms. At 4 kHz eight time constants are 0.3 ms: a hundred steps
from frame to frame of a webcam, whose light between frames is a guess of milliseconds anyway."""


class PhotoreceptorBandwidth(Effect):
    """Low pass of the logarithmic response: cutoff_hz (L + dark_dn)/(reference_dn + dark_dn), follower_hz.

    Both are first order, in steps that are exact for an input that is a straight line over the step: with
    a = h/tau, E = exp(-a), P = (1 - E)/a, an input going from u0 to u1 takes the output from v0 to

        u1 - P (u1 - u0) + E (v0 - u0)

    tau is that of the mean light of the step. The linearised response of the paper's law is not filtered.
    """

    about: ClassVar[About] = "pixel"
    signature: ClassVar[str] = (
        "events lag behind the light, by 1/(2 pi cutoff), more in the dark; fast flicker fades"
    )

    cutoff_hz: float = quantity(
        0.0, unit="Hz", ge=0, le=100_000, meaning="3 dB frequency at reference_dn; 0: no limit, nor follower",
        source="300, noisy 30: v2e (Hu, Liu, Delbruck 2021); 1600 to 4000: tau 40 to 100 us, 1 klux, IEBCS",
    )  # fmt: skip
    reference_dn: float = quantity(
        255.0, unit="DN", ge=0, le=1e6, meaning="brightness of that frequency", source="v2e: white"
    )
    dark_dn: float = quantity(
        20.0, unit="DN", gt=0, le=10_000, meaning="added to the brightness: what it is slowest with",
        source="v2e (Hu, Liu, Delbruck 2021): 20/275 of the frequency is left at 0 DN",
    )  # fmt: skip
    follower_hz: float = quantity(
        0.0, unit="Hz", ge=0, le=1e6, meaning="3 dB frequency of the source follower behind it; 0: no limit",
        source="kHz at usual biases; one pole is nearly always dominant (v2e)",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.cutoff_hz > 0

    @property
    def longest_step_us(self) -> float:
        return max(SHORT_US, STEP_IN_TIME_CONSTANTS * 1e6 / (2 * math.pi * self.cutoff_hz))

    def state(self, sensor: Sensor) -> State:
        pixels = sensor.width * sensor.height
        return {name: np.zeros(pixels, np.float32) for name in ("input", "photoreceptor", "follower")}

    def respond(self, band: Band) -> None:
        own = band.planes[self.name]
        planes: tuple[Plane, Plane, Plane] = own["input"], own["photoreceptor"], own["follower"]
        if band.span_us == 0:  # the image has been there for long
            for plane in planes:
                plane[:] = band.response
            return
        radians = 2e-6 * math.pi * band.span_us
        per_dn = radians * self.cutoff_hz / (self.reference_dn + self.dark_dn)
        decay, mean = 0.0, 0.0
        if self.follower_hz > 0:
            a = radians * self.follower_hz
            decay, mean = math.exp(-a), -math.expm1(-a) / a
        low_pass(
            band.light_before, band.light, np.float32(self.dark_dn), np.float32(per_dn),
            np.float32(decay), np.float32(mean), *planes, band.response,
        )  # fmt: skip


_HALF, _1, _16 = np.float32(0.5), np.float32(1), np.float32(16)
_15, _105, _420, _945 = np.float32(15), np.float32(105), np.float32(420), np.float32(945)
_1_16TH = np.float32(1 / 16)


@kernel
def low_pass(
    before: Any, light: Any, dark: Any, per_dn: Any, decay: Any, mean: Any, input_: Any, first: Any,
    second: Any, response: Any,
) -> Any:  # fmt: skip
    """One step of both poles; response is the input and becomes the output.

    E and P come from tanh x = x (945 + 105 y + y^2)/(945 + 420 y + 15 y^2), y = x^2, which is exact to 3e-8
    at x = a/16 <= 1, and three doublings, P(2b) = P(b) (1 + E(b))/2 and E(2b) = E(b)^2. Beyond a = 16 E is 0.
    """
    for i in range(response.shape[0]):
        a = per_dn * (_HALF * (before[i] + light[i]) + dark)
        x = _1_16TH * min(a, _16)
        y = x * x
        top, bottom = _945 + y * (_105 + y), _945 + y * (_420 + _15 * y)
        inverse = _1 / (bottom + x * top)
        e, p = (bottom - x * top) * inverse, top * inverse
        p *= _HALF * (_1 + e)
        e *= e
        p *= _HALF * (_1 + e)
        e *= e
        p *= _HALF * (_1 + e)
        e *= e
        p = p if a <= _16 else _1 / a
        u0, u1, v0 = input_[i], response[i], first[i]
        v1 = u1 - p * (u1 - u0) + e * (v0 - u0)
        w1 = v1 - mean * (v1 - v0) + decay * (second[i] - v0)
        input_[i], first[i], second[i], response[i] = u1, v1, w1, w1
