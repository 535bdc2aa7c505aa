r"""When a Brownian motion with drift leaves its band: the exact law.

Between two frames the voltage of a pixel is V(t) = V0 + mu t + sigma W(t), in units of the nominal
threshold. It gives an ON event at +theta_on, an OFF event at -theta_off, and restarts from 0.
Writing v = sigma^2 T for the variance gathered over a span T:

* The end point is drawn once, V1 ~ N(V0 + mu T, v). Given both ends the path is a Brownian bridge,
  in which mu no longer appears.
* A bridge from x to y over T touches the level a, both ends on its near side, with probability

      exp(-2 (a - x)(a - y) / v)                                                   (reflection)

  and surely when y lies beyond a.
* Given that it is touched, the first time is tau = T s / (1 + s) with s inverse Gaussian,

      s ~ IG(mean |a - x| / |a - y|, shape (a - x)^2 / v).

  (The time change u = T t / (T - t) turns the bridge into a Brownian motion hitting a sloped line.)
* A reset subtracts the barrier from the rest of the path, so what remains is again a bridge, from 0
  to V1 - a over T - tau.
* With two barriers A above and -B below, W = A + B, a bridge with both ends in the band touches A
  and then -B with probability exp(-2 W (W + y - x) / v), the other way round with y - x reversed.
  Where that is below `MISS` the two single-barrier laws are exclusive and just added. Where it is
  not, the bridge is cut at its middle, N((x + y)/2, v/4), until it is. Both steps are exact, so the
  whole is, to `MISS` per cut; and no alternating series is needed.

References: Borodin and Salminen, Handbook of Brownian Motion (2002), part II; Michael, Schucany and
Haas, The American Statistician 30 (1976) 88, for the inverse Gaussian; Karatzas and Shreve (1991),
section 4.3.C, for bridges.
"""

import math
from typing import Any

from .kernel import kernel
from .random import normal, uniform

MISS = 1e-12
"""Probability of an error that one step of the sampler may make."""
LOG_MISS = math.log(MISS)


@kernel
def inverse_gaussian(state: Any, inverse_mean: Any, shape: Any) -> Any:
    """(next state, number from IG(1/inverse_mean, shape)); inverse_mean = 0 is the Levy law.

    The smaller root of Michael, Schucany and Haas, written so that nothing cancels: with
    w = nu / (2 shape) it is 1 / (m + w + sqrt(w^2 + 2 w m)), m the inverse mean.
    """
    state, gauss = normal(state)
    state, u = uniform(state)
    w = gauss * gauss / (2.0 * shape)
    root = 1.0 / (inverse_mean + w + math.sqrt(w * (w + 2.0 * inverse_mean)))
    if u * (1.0 + root * inverse_mean) <= 1.0:
        return state, root
    return state, 1.0 / (inverse_mean * inverse_mean * root)


@kernel
def touching_time(state: Any, distance: Any, beyond: Any, span: Any, variance: Any) -> Any:
    """(next state, first time a bridge touches a barrier that it does touch).

    distance: from the start to the barrier, >= 0; beyond: |barrier - end|; span, variance of the bridge.
    """
    if distance <= 0.0:
        return state, 0.0
    state, gauss = normal(state)
    state, u = uniform(state)
    return state, span * touching_share(distance, beyond, variance, gauss, u)


@kernel
def touching_share(distance: Any, beyond: Any, variance: Any, gauss: Any, u: Any) -> Any:
    """The share s/(1 + s) of the span, s as `inverse_gaussian` makes it from a normal and a uniform number.

    Multiplied out, so that there is one division and no limit is special; distance > 0.
    """
    q = 0.5 * gauss * gauss * variance
    c = distance * beyond
    r = c + q + math.sqrt(q * (q + 2.0 * c))
    near, far = distance * distance, beyond * beyond
    first = u * (r + c) <= r
    return (near if first else r) / ((near if first else far) + r)


@kernel
def touch_probability(near: Any, far: Any, variance: Any) -> Any:
    """Probability, 0 below MISS, that a bridge touches a barrier at distances near (start) and far (end)."""
    if near <= 0.0 or far <= 0.0:
        return 1.0
    if near * far >= -0.5 * LOG_MISS * variance:
        return 0.0
    return math.exp(-2.0 * near * far / variance)


@kernel
def needs_cut(x: Any, y: Any, above: Any, below: Any, variance: Any) -> Any:
    """True when one bridge from x to y may touch both barriers, +above and -below."""
    if variance <= 0.0 or x >= above or x <= -below:
        return False
    limit = -0.5 * LOG_MISS * variance
    if y >= above:
        return (x + below) * (y + below) < limit
    if y <= -below:
        return (above - x) * (above - y) < limit
    if (above - x) * (above - y) >= limit or (x + below) * (y + below) >= limit:
        return False
    band = above + below
    return band * (band - abs(y - x)) < limit


@kernel
def stays_inside(x: Any, y: Any, above: Any, below: Any, variance: Any) -> Any:
    """True when a bridge from x to y touches a barrier with probability below MISS: most that were near."""
    limit = -0.5 * LOG_MISS * variance
    ends_inside = (y < above) & (y > -below) & (x < above) & (x > -below)
    return ends_inside & ((above - x) * (above - y) > limit) & ((x + below) * (y + below) > limit)


@kernel
def exit_of_bridge(state: Any, x: Any, y: Any, span: Any, variance: Any, above: Any, below: Any) -> Any:
    """(next state, side, time) at which a bridge that needs no cut first leaves its band.

    side is +1 (ON), -1 (OFF) or 0 (it stays inside; then time = span).
    """
    if x >= above or (y >= above and x > -below):
        side = 1
    elif x <= -below or y <= -below:
        side = -1
    else:
        up = touch_probability(above - x, above - y, variance)
        down = touch_probability(x + below, y + below, variance)
        side = 0
        if up + down > 0.0:
            state, u = uniform(state)
            side = 1 if u < up else (-1 if u < up + down else 0)
    if side == 0:
        return state, 0, span
    barrier = above if side > 0 else -below
    state, time = touching_time(state, abs(barrier - x), abs(barrier - y), span, variance)
    return state, side, time
