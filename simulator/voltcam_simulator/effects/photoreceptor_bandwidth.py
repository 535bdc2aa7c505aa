"""The photoreceptor follows the light only so fast, and the slower the darker it is."""

import math
from typing import Any, ClassVar

import numpy as np

from ..bends import depth, fading
from ..effect import About, Band, Effect, Sensor, State, quantity
from ..kernel import kernel
from ..plane_kernels import copy


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

    def state(self, sensor: Sensor) -> State:
        pixels = sensor.width * sensor.height
        return {name: np.zeros(pixels, np.float32) for name in ("input", "photoreceptor", "follower")}

    def respond(self, band: Band) -> None:
        own = band.planes[self.name]
        input_, photoreceptor, follower = (own[name] for name in ("input", "photoreceptor", "follower"))
        if band.span_us == 0:  # the image has been there for long
            for plane in (input_, photoreceptor, follower):
                band.apply(copy, band.response, plane)
            return
        radians = 2e-6 * math.pi * band.span_us
        per_dn = np.float32(min(radians * self.cutoff_hz / (self.reference_dn + self.dark_dn), MOST_PER_DN))
        before = [band.copied(plane) for plane in (input_, photoreceptor)] if self.follower_hz > 0 else []
        band.apply(
            low_pass, band.light_before, band.light, np.float32(self.dark_dn), per_dn, input_, photoreceptor,
            band.response, band.bow, band.rate,
        )  # fmt: skip
        if self.follower_hz > 0:
            band.apply(
                follow, *before, input_, radians * self.follower_hz, follower, band.response, band.bow,
                band.rate,
            )  # fmt: skip
        band.is_bent = True


_1, _2, _4, _HALF, _1_6TH, _1_360TH = (np.float32(v) for v in (1, 2, 4, 1 / 2, 1 / 6, 1 / 360))
SLOWEST, FASTEST = np.float32(1e-12), np.float32(1e6)
"""Time constants in a step: a slower pole does not move, a faster one follows at once. Products of what lies
between are numbers in single precision."""
MOST_PER_DN = 1e25
"""Time constants in a step for each DN: a number in single precision also in the brightest light, 1e12 DN."""
NEARLY_STRAIGHT = 0.01
"""Time constants in a step below which the first pole's output is taken as straight: off by an eighth of that
of its way, at most."""


@kernel
def mean_rate(a0: Any, a1: Any) -> Any:
    """Of a rate that goes from a0 to a1 as a power: their logarithmic mean, to 1 % if one is eleven times the
    other (Simpson's rule)."""
    return (_4 * math.sqrt(a0 * a1) + a0 + a1) * _1_6TH


@kernel
def low_pass(
    before: Any, light: Any, dark: Any, per_dn: Any, input_: Any, photoreceptor: Any, response: Any,
    bow: Any, rate: Any,
) -> None:  # fmt: skip
    """One step of the first pole; response is the input and becomes the output. bow, rate: see `Bend`."""
    for i in range(response.shape[0]):
        a0 = min(max(per_dn * (before[i] + dark), SLOWEST), FASTEST)
        a1 = min(max(per_dn * (light[i] + dark), SLOWEST), FASTEST)
        a = mean_rate(a0, a1)
        q = fading(a)
        left = _1 - q
        series = _1 - a * (_1_6TH - a * a * _1_360TH)
        share = series if a < _HALF else _2 / a - _2 * left * left / (q * (_1 + left))
        late = mean_rate(a1 + (a0 - a1) * share, a1)
        u0, u1, v0 = input_[i], response[i], photoreceptor[i]
        behind, way = v0 - u0, u1 - u0
        v1 = u1 - q * (_1 + left) / late * way + left * left * behind
        bow[i], rate[i] = -depth(a) * (behind + way / a), a
        input_[i], photoreceptor[i], response[i] = u1, v1, v1


@kernel
def follow(
    input_before: Any, photoreceptor_before: Any, input_: Any, b: Any, follower: Any, response: Any,
    bow: Any, rate: Any,
) -> None:  # fmt: skip
    """One step of the second pole, b its time constants in the step; response is its input and becomes its
    output. Its bend is told as that of one pole as late as both."""
    decay, mean = math.exp(-b), -math.expm1(-b) / b
    for i in range(response.shape[0]):
        a, v0, v1, w0 = np.float64(rate[i]), photoreceptor_before[i], response[i], follower[i]
        u0, way = input_before[i], input_[i] - input_before[i]
        transient = v0 - u0 + way / a if a > NEARLY_STRAIGHT else 0.0
        left = math.exp(-a)
        if abs(b - a) < 1.0:
            passed = b * decay * (math.expm1(b - a) / (b - a) if b != a else 1.0)
        else:
            passed = b * (left - decay) / (b - a)
        line0, line1 = v0 - transient, v1 - transient * left
        w1 = line1 - mean * (line1 - line0) + decay * (w0 - line0) + transient * passed
        both = max(a * b / (a + b), SLOWEST)
        bow[i], rate[i] = -depth(both) * (w0 - u0 + way / both), both
        follower[i], response[i] = w1, w1
