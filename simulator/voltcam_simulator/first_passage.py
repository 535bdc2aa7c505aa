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

Noise is lazy: while the barriers are more than `REACH` pending standard deviations away nothing can
happen, so drift adds to a mean and noise to a pending variance, and nothing is drawn.

References: Borodin and Salminen, Handbook of Brownian Motion (2002), part II; Michael, Schucany and
Haas, The American Statistician 30 (1976) 88, for the inverse Gaussian; Karatzas and Shreve (1991),
section 4.3.C, for bridges.
"""

import math
from typing import Any

import numpy as np

from .kernel import kernel
from .random import normal, sequence, uniform

MISS = 1e-12
"""Probability of an error that one step of the sampler may make."""
LOG_MISS = math.log(MISS)
REACH = 7.4
"""Standard deviations beyond which a barrier is out of reach: 4 Q(7.4) < 3e-13."""
DEEPEST = 64
"""Halvings of an interval after which its two ends are the same number."""

# How an event is packed into 64 bits, so that sorting the numbers sorts the events by time:
# 37 bits microseconds since the frame before (38 hours), 13 bits y, 13 bits x, 1 bit polarity.
TIME_BITS, AXIS_BITS = 37, 13
_TIME_SHIFT, _Y_SHIFT, _X_SHIFT = np.uint64(27), np.uint64(14), np.uint64(1)
_AXIS_MASK, _ONE = np.uint64(0x1FFF), np.uint64(1)


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
    if variance <= 0.0:
        return state, span * distance / (distance + beyond)
    state, s = inverse_gaussian(state, beyond / distance, distance * distance / variance)
    if s < 1e300:
        return state, span * (s / (1.0 + s))
    return state, span


@kernel
def touch_probability(near: Any, far: Any, variance: Any) -> Any:
    """Probability that a bridge touches a barrier at distances near (start) and far (end)."""
    if near <= 0.0 or far <= 0.0:
        return 1.0
    if variance <= 0.0:
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
        state, u = uniform(state)
        side = 1 if u < up else (-1 if u < up + down else 0)
    if side == 0:
        return state, 0, span
    barrier = above if side > 0 else -below
    state, time = touching_time(state, abs(barrier - x), abs(barrier - y), span, variance)
    return state, side, time


@kernel
def pixel_events(
    state: Any, x: Any, y: Any, span: Any, noise2: Any, above: Any, below: Any,
    address: Any, cuts: Any, keys: Any, written: Any,
) -> Any:  # fmt: skip
    """All events of one pixel over one interval, its path going from x to y if there were no resets.

    noise2: sigma^2 [1/us]; span [us]; cuts (2, DEEPEST + 1): room for the ends of bridges that were cut.
    Fills keys[written:]. Returns (written, voltage at the end), written being -1 when keys is full.
    """
    times, voltages = cuts[0], cuts[1]
    times[0], voltages[0] = span, y
    depth, now, fallen = 0, 0.0, 0.0  # fallen: what resets have subtracted from the path so far
    while depth >= 0:
        left = times[depth] - now
        end = voltages[depth] - fallen
        variance = noise2 * left
        if depth < DEEPEST and needs_cut(x, end, above, below, variance):
            state, gauss = normal(state)
            depth += 1
            times[depth] = now + 0.5 * left
            voltages[depth] = 0.5 * (x + end) + 0.5 * math.sqrt(variance) * gauss + fallen
            continue
        state, side, time = exit_of_bridge(state, x, end, left, variance, above, below)
        if side == 0:
            now, x = times[depth], end
            depth -= 1
            continue
        if written == keys.shape[0]:
            return -1, 0.0
        now += time
        keys[written] = event_key(min(now, span), address, side)
        written += 1
        fallen += above if side > 0 else -below
        x = 0.0
    return written, x


@kernel
def gather(
    voltage: Any, pending: Any, drift: Any, noise: Any, span: Any, above: Any, below: Any, near: Any
) -> Any:
    """The lazy step: let drift and noise gather where no barrier is within reach.

    All arrays (pixels,) float32; near (pixels + 1,) int32 receives the indices of the other pixels, which
    stay as they were. Returns their number. Two loops, because the first is then vectorised.
    """
    reach2 = np.float32(REACH * REACH)
    far = np.empty(voltage.shape[0], np.bool_)
    for i in range(voltage.shape[0]):
        start = voltage[i]
        end = start + drift[i]
        variance = pending[i] + noise[i] * noise[i] * span
        closest = min(above[i] - max(start, end), below[i] + min(start, end))
        far[i] = (closest > 0) & (closest * closest > reach2 * variance)
        voltage[i] = end if far[i] else start
        pending[i] = variance if far[i] else pending[i]
    count = 0
    for i in range(voltage.shape[0]):
        near[count] = i
        count += not far[i]
    return count


@kernel
def cross(
    voltage: Any, pending: Any, drift: Any, noise: Any, span: Any, above: Any, below: Any, near: Any,
    first: Any, count: Any, key: Any, pixel0: Any, width: Any, keys: Any,
) -> Any:  # fmt: skip
    """Draw the paths of the pixels near[first:count] and pack their events into keys.

    key: `interval_key` of the interval. Returns (pixels done, events written). Stops before the pixel whose
    events do not fit into keys (capacity,) uint64; call again with more room, the same numbers are drawn.
    """
    written = 0
    root = math.sqrt(span)
    cuts = np.empty((2, DEEPEST + 1))
    for k in range(first, count):
        i = near[k]
        state = sequence(key, pixel0 + i)
        above_i, below_i, sigma = np.float64(above[i]), np.float64(below[i]), np.float64(noise[i])
        x = np.float64(voltage[i])
        if pending[i] > 0.0:
            state, gauss = normal(state)
            x += math.sqrt(pending[i]) * gauss
        x = min(max(x, -below_i), above_i)  # beyond only by rounding, or where a threshold was lowered
        state, gauss = normal(state)
        y = x + drift[i] + sigma * root * gauss
        if not stays_inside(x, y, above_i, below_i, sigma * sigma * span):
            address = event_address(pixel0 + i, width)
            done, y = pixel_events(
                state, x, y, span, sigma * sigma, above_i, below_i, address, cuts, keys, written
            )
            if done < 0:
                return k, written
            written = done
        voltage[i] = y
        pending[i] = 0.0
    return count, written


@kernel
def stays_inside(x: Any, y: Any, above: Any, below: Any, variance: Any) -> Any:
    """True when a bridge from x to y touches a barrier with probability below MISS: most that were near."""
    limit = -0.5 * LOG_MISS * variance
    ends_inside = y < above and y > -below and x < above and x > -below
    return ends_inside and (above - x) * (above - y) > limit and (x + below) * (y + below) > limit


@kernel
def event_address(pixel: Any, width: Any) -> Any:
    """The pixel's coordinates at their place in an event key."""
    y = pixel // width
    return (np.uint64(y) << _Y_SHIFT) | (np.uint64(pixel - y * width) << _X_SHIFT)


@kernel
def event_key(time: Any, address: Any, side: Any) -> Any:
    """One event in 64 bits; time [us] since the frame before, rounded down to a microsecond."""
    return (np.uint64(time) << _TIME_SHIFT) | address | (_ONE if side > 0 else np.uint64(0))


@kernel
def unpack(keys: Any, start_us: Any, t: Any, x: Any, y: Any, p: Any) -> None:
    """Sorted event keys to the columns of an event array."""
    for i in range(keys.shape[0]):
        key = keys[i]
        t[i] = start_us + np.int64(key >> _TIME_SHIFT)
        y[i] = (key >> _Y_SHIFT) & _AXIS_MASK
        x[i] = (key >> _X_SHIFT) & _AXIS_MASK
        p[i] = (key & _ONE) != 0


@kernel
def start_voltage(
    voltage: Any, drift: Any, noise: Any, above: Any, below: Any, key: Any, pixel0: Any
) -> None:
    """Voltages of pixels that have been looking at a still scene for long: the stationary law.

    drift [1/us] and noise [1/sqrt(us)] of the still scene; key: `interval_key`. With nu = 2 mu / sigma^2 the
    density of a Brownian motion that restarts at 0 when it leaves (-B, A) is, up to its height at 0,

        (1 - exp(-nu (A - x))) / (1 - exp(-nu A))             for x >= 0
        (exp(nu x) - exp(-nu B)) / (1 - exp(-nu B))           for x < 0

    (Green's function of the generator: the tent for nu = 0, uniform on (0, A) for pure drift). Starting
    there, a still scene gives its long-run event rate from the first microsecond on, and not a burst of
    leak events after 1/mu. Drawn by rejection from the uniform law.
    """
    for i in range(voltage.shape[0]):
        state = sequence(key, pixel0 + i)
        mu, sigma = np.float64(drift[i]), np.float64(noise[i])
        side = 1.0 if mu >= 0.0 else -1.0
        a, b = (above[i], below[i]) if mu >= 0.0 else (below[i], above[i])
        nu = 0.0 if mu == 0.0 else (2.0 * abs(mu) / (sigma * sigma) if sigma > 0.0 else math.inf)
        while True:
            state, place = uniform(state)
            state, u = uniform(state)
            x = place * (a + b) - b
            if u < stationary_density(x, nu, a, b):
                break
        voltage[i] = side * x


@kernel
def stationary_density(x: Any, nu: Any, a: Any, b: Any) -> Any:
    """The stationary density at x relative to its value at 0, for nu >= 0 (inf: no noise)."""
    if x >= 0.0:
        if nu * a > 700.0:
            return 1.0 - math.exp(-nu * (a - x)) if nu < math.inf else 1.0
        return math.expm1(-nu * (a - x)) / math.expm1(-nu * a) if nu * a > 1e-12 else (a - x) / a
    if nu * b > 700.0:
        return math.exp(nu * x) if nu < math.inf else 0.0
    if nu * b > 1e-12:
        return (math.exp(nu * x) - math.exp(-nu * b)) / -math.expm1(-nu * b)
    return (x + b) / b
