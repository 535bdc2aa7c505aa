"""How likely same-pixel intervals are, along the path the light took, for given parameters.

After an event a pixel starts at 0. Its voltage has the mean path

    M(t) = k1 ln((L(t) + k2)/(L(0) + k2)) + k4 t + k5 integral L        (Eq. 1, 10)

and the variance S(t) = integral sigma^2, sigma = k3 sqrt(L)/(L + k2) + k6 (Eq. 11). The first passage through
a barrier theta has, where the path is not far from straight in the last stretch, the density (tangent
approximation: Durbin, J. Appl. Prob. 22, 1985; exact for a straight path, where it is the inverse Gaussian
law)

    p(t) = (M'(t) + sigma^2 x/S) N(x; 0, S),    x = theta - M(t).

What is uncertain beside the Wiener process is a normal shift of theta - x with variance E (reset noise, error
of the light); it can be integrated out: S becomes S + E in both places. What stays with a pixel (its own
thresholds, its own leak) is common to its intervals and is integrated out over all of them together.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr

from ..light.grey import USUAL_DARK_DN
from .intervals import Intervals
from .rest import NO_WAITS, Waits, log_likelihood

Vector = NDArray[np.float64]

START = {
    "k1": 5.0, "k2_dn": USUAL_DARK_DN, "k3": 1e-4, "k4_per_us": 1e-7, "k5_per_dn_us": 1e-8, "k6": 1e-5,
    "on_over_off": 1.0, "threshold_spread": 0.02, "leak_spread": 0.05, "reset_spread": 0.001,
    "light_error_dn": 0.3, "light_error_share": 0.002, "light_wander": 3e-5, "bend_error": 0.3,
}  # fmt: skip
"""Parameters of the likelihood, all positive, and where the search begins: the camera's first, then what
spreads. Light that moves is off by grey levels, by a share of its brightness, by more the longer it moves
[1/sqrt(us)], and by what frames surprise: without the second and third, it would pass for noise of pixels."""

LARGEST = {"threshold_spread": 0.2, "leak_spread": 1.0, "reset_spread": 0.5}
"""What may be larger only because something else is wrong: spreads take in whatever is not understood.

Thresholds of a DAVIS240 differ by 3.5 % of contrast (Brandli et al. 2014), those of a DVS128 by 2.1 %
(Lichtsteiner et al. 2008): of a threshold of 20 % of contrast, a sixth and a tenth."""

LEAST_SIGMA = 1e-8
LEAST_SPEED = 1e-10
OUTLIER = 0.01
"""Share of the intervals whose missing event is not held against the model: light the frames do not show."""


@dataclass(frozen=True, eq=False)
class Terms:
    """What the model says of each interval; arrays (n,)."""

    rise: Vector  # M in the direction of the end (of ON where none was seen)
    speed: Vector  # its slope there [1/us]
    leak_speed: Vector  # the part of `speed` that the leak made
    wiener: Vector  # S
    wiener_rate: Vector  # sigma^2 at the end [1/us]
    error: Vector  # E
    leaked: Vector  # the part of `rise` that the leak made
    highest: Vector  # of M on the way
    lowest: Vector
    theta: Vector  # the barrier in the direction of the end


def terms(seen: Intervals, dead_us: float, p: Mapping[str, float]) -> Terms:
    """The model's terms for parameters `p` (as START) when pixels are held for dead_us after an event."""
    before, after, mean = (seen[name].astype(np.float64) for name in ("before", "after", "mean"))
    lowest, highest = seen["lowest"].astype(np.float64), seen["highest"].astype(np.float64)
    side = np.where(seen["end"] < 0, -1.0, 1.0)
    k1, k2 = p["k1"], p["k2_dn"]
    free_us = np.maximum(seen["end_us"] - seen["start_us"] - dead_us, 1.0)
    dark = np.log(before + k2)
    leaked = (p["k4_per_us"] + p["k5_per_dn_us"] * mean) * free_us
    blurred = np.minimum(highest - lowest, 1.0)  # light that stands still has no error of its change
    rate = noise_rate(mean, p) + blurred * p["light_wander"] ** 2
    share2 = (p["light_error_share"] * (mean + k2)) ** 2
    bend2 = (p["bend_error"] * seen["doubt"].astype(np.float64)) ** 2
    light_error2 = blurred * (p["light_error_dn"] ** 2 + share2) + bend2
    error = p["reset_spread"] ** 2 + light_error2 * (k1 / (mean + k2)) ** 2
    leak_rate = p["k4_per_us"] + p["k5_per_dn_us"] * after
    ratio = np.sqrt(p["on_over_off"])
    return Terms(
        rise=side * (k1 * (np.log(after + k2) - dark) + leaked),
        speed=side * (k1 * seen["slope"] / (after + k2) + leak_rate),
        leak_speed=side * leak_rate,
        wiener=rate * free_us,
        wiener_rate=rate,
        error=error,
        leaked=side * leaked,
        highest=k1 * (np.log(highest + k2) - dark) + leaked,
        lowest=k1 * (np.log(lowest + k2) - dark),
        theta=np.where(side > 0, ratio, 1 / ratio),
    )


def noise_rate(level: Vector, p: Mapping[str, float]) -> Vector:
    """sigma^2 [1/us] at a light (n,) [DN] (Eq. 11); where k3 or k6 is negative, never quite 0."""
    sigma = p["k3"] * np.sqrt(level) / (level + p["k2_dn"]) + p["k6"]
    return np.asarray(np.maximum(sigma, LEAST_SIGMA) ** 2)


class Likelihood:
    """The log likelihood of intervals, robust against events the model does not know.

    `weights` (n,) are each interval's chance to be the model's own; `reweigh` sets them, and the rates of
    ON and OFF events that come out of the blue, from the model as it stands (an EM step).
    """

    def __init__(self, seen: Intervals, dead_us: float, waits: Waits = NO_WAITS) -> None:
        side = np.where(seen["end"] < 0, 1, 0)
        ended = seen["end"] != 0
        order = np.lexsort((side, seen["pixel"], ~ended))
        self.seen, self.dead_us, self.waits = seen[order], dead_us, waits
        self.events = int(ended.sum())
        self.pixels, self._pixel = np.unique(self.seen["pixel"], return_inverse=True)
        member = self._pixel[: self.events] * 2 + (self.seen["end"][: self.events] < 0)
        groups, self._group = np.unique(member, return_inverse=True)  # ON and OFF of a pixel: own thresholds
        self._pixel_of_group = groups // 2
        self.part_pixel = np.concatenate([self.pixels, waits["pixel"]])
        self.counts = np.concatenate([np.ones(len(self.pixels)), waits["count"]])
        self.span_us = max(float((self.seen["end_us"] - self.seen["start_us"]).sum()), 1.0)
        self.weights: Vector = np.ones(self.events)
        self.stray_per_us = np.full(2, 1e-9)

    def parts(self, p: Mapping[str, float]) -> Vector:
        """The log likelihood of each pixel's intervals, and of each wait, by `part_pixel`."""
        level = self.waits["level"].astype(np.float64)
        leak, noise = p["k4_per_us"] + p["k5_per_dn_us"] * level, noise_rate(level, p)
        waited = log_likelihood(self.waits, leak, noise, float(np.sqrt(p["on_over_off"])))
        return np.concatenate([self._by_pixel(p), waited])

    def _by_pixel(self, p: Mapping[str, float]) -> Vector:
        t = terms(self.seen, self.dead_us, p)
        own, less_leak, spread = self._own(t, p)
        passed = self.weights * (self._log_density(t, own, less_leak) + self._not_other(t, p))
        each = np.concatenate([passed, self._log_survival(t, p)])
        by_pixel = np.bincount(self._pixel, each, minlength=len(self.pixels))
        common = np.bincount(self._pixel_of_group, spread, minlength=len(self.pixels))
        return np.asarray(by_pixel + common, np.float64)

    def _log_density(self, t: Terms, own: Vector, less_leak: Vector) -> Vector:
        """ln p(t) of the intervals with an event, without what their pixel has in common."""
        n = self.events
        x, variance = (t.theta - t.rise)[:n], (t.wiener + t.error)[:n]
        speed = self._speed(t, x - own, variance, less_leak)
        return np.log(speed) - 0.5 * (np.log(2 * np.pi * variance) + x * x / variance)

    def _speed(self, t: Terms, rest: Vector, variance: Vector, less_leak: Vector) -> Vector:
        """How fast the pixels, each with its own leak, come upon the barrier."""
        n = self.events
        speed = t.speed[:n] - less_leak * t.leak_speed[:n] + t.wiener_rate[:n] * rest / variance
        return np.asarray(np.maximum(speed, LEAST_SPEED))

    def _own(self, t: Terms, p: Mapping[str, float]) -> tuple[Vector, Vector, Vector]:
        """The part of each x (events,) that is the pixel's own, the share by which its leak is less than
        others' (events,), and what that adds to each group's log density.

        With x = u a + v b + noise, a ~ N(0, m^2) and b ~ N(0, s^2) common to a pixel: a two-by-two system.
        """
        n, g = self.events, self._group
        x, precision = (t.theta - t.rise)[:n], self.weights / (t.wiener + t.error)[:n]
        u, v = t.theta[:n], -t.leaked[:n]
        m2, s2 = p["threshold_spread"] ** 2, p["leak_spread"] ** 2
        uu = np.bincount(g, precision * u * u) + 1 / m2
        vv = np.bincount(g, precision * v * v) + 1 / s2
        uv = np.bincount(g, precision * u * v)
        ux, vx = np.bincount(g, precision * u * x), np.bincount(g, precision * v * x)
        determinant = uu * vv - uv * uv
        a, b = (vv * ux - uv * vx) / determinant, (uu * vx - uv * ux) / determinant
        spread = 0.5 * (a * ux + b * vx) - 0.5 * np.log(determinant * m2 * s2)
        return u * a[g] + v * b[g], b[g], spread

    def _width(self, t: Terms, p: Mapping[str, float]) -> Vector:
        own = (p["threshold_spread"] * t.theta) ** 2 + (p["leak_spread"] * t.leaked) ** 2
        return np.sqrt(t.wiener + t.error + own)

    def _not_other(self, t: Terms, p: Mapping[str, float]) -> Vector:
        """ln P(the other barrier was not met on the way), of intervals with an event."""
        ratio, seen = np.sqrt(p["on_over_off"]), slice(None, self.events)
        room = np.where(self.seen["end"][seen] < 0, ratio - t.highest[seen], 1 / ratio + t.lowest[seen])
        return _lenient(log_ndtr(room / self._width(t, p)[seen]))

    def _log_survival(self, t: Terms, p: Mapping[str, float]) -> Vector:
        """ln P(no barrier was met), of intervals whose end was not seen."""
        ratio, unseen = np.sqrt(p["on_over_off"]), slice(self.events, None)
        width = self._width(t, p)[unseen]
        up, down = (ratio - t.highest[unseen]) / width, (1 / ratio + t.lowest[unseen]) / width
        return _lenient(log_ndtr(up) + log_ndtr(down))

    def reweigh(self, p: Mapping[str, float]) -> Vector:
        """Set `weights` and `stray_per_us` from the model with parameters `p`.

        Returns the log likelihood of each of `seen` with events as a mixture of the model's own and others,
        whose mean over events may be compared between readings of the same recording.
        """
        t = terms(self.seen, self.dead_us, p)
        n = self.events
        variance = (t.wiener + t.error)[:n]
        shift, less_leak, _ = self._own(t, p)
        rest = (t.theta - t.rise)[:n] - shift
        speed = self._speed(t, rest, variance, less_leak)
        own = speed * np.exp(-0.5 * rest**2 / variance) / np.sqrt(2 * np.pi * variance)
        off = (self.seen["end"][:n] < 0).astype(np.intp)
        stray = self.stray_per_us[off] * np.exp(self._not_other(t, p))
        self.weights = own / (own + stray)
        lost = np.bincount(off, 1 - self.weights, minlength=2)
        self.stray_per_us = np.maximum(lost / self.span_us, 1e-12)
        return np.concatenate([np.log(own + stray), self._log_survival(t, p)])


def _lenient(log_probability: Vector) -> Vector:
    """Of a probability that is never below OUTLIER."""
    return np.asarray(np.logaddexp(np.log1p(-OUTLIER) + log_probability, np.log(OUTLIER)))
