r"""Algorithm 1 of the paper as its authors run it: the `paper` law, for comparison.

For each pixel and frame, with the residual V from the frame before and A, B the distances to ON and OFF:
the polarity is drawn from P(ON) = (e^{2mB} - 1)/(e^{2mB} - e^{-2mA}), m = mu/sigma^2 (Eq. 12; as printed it
has A and B exchanged), then the time from the inverse Gaussian law (Eq. 13), Levy's for mu = 0 (Eq. 14). A
time after the frame's end gives no event: the residual grows by its share, signed distance times time left
over tau, and the next frame draws anew. That redrawing averages the noise: with x = mu T/theta the share of
the way made in a frame of length T, the variance of the voltage is about sigma^2 T ln(1/x) where Brownian
motion has sigma^2 T/x, so the spread of leak intervals shrinks as the frame rate grows.
Dead time, reset noise and kicks are not part of it.
"""

import math
from typing import Any

import numpy as np

from .event_key import event_address, event_key
from .first_passage import inverse_gaussian
from .kernel import kernel
from .random import sequence, uniform


@kernel
def on_probability(mu: Any, sigma2: Any, up: Any, down: Any) -> Any:
    """P(+up is reached before -down), Eq. 12; mu in 1/us, sigma2 in 1/us, distances in thresholds."""
    if sigma2 <= 0.0:
        return 0.5 if mu == 0.0 else (1.0 if mu > 0.0 else 0.0)
    m = 2.0 * mu / sigma2
    if abs(m) * (up + down) < 1e-9:
        return down / (up + down)
    if m > 0.0:
        return math.expm1(-m * down) / math.expm1(-m * (up + down))
    return math.exp(m * up) * math.expm1(m * down) / math.expm1(m * (up + down))


@kernel
def cross_by_paper(
    voltage: Any, pending: Any, held: Any, above: Any, below: Any, drift: Any, noise: Any,
    key: Any, span_us: Any, offset_us: Any, first_pixel: Any, width: Any, first: Any, keys: Any,
) -> Any:  # fmt: skip
    """All pixels from `first` on, over one interval; returns the same as `crossings.cross`.

    Called as cross_by_paper(*pixels, *motion, *step, first, keys), see `groups`.
    """
    written = 0
    for i in range(first, voltage.shape[0]):
        state = sequence(key, first_pixel + i)
        mu, sigma2 = drift[i] / span_us, np.float64(noise[i]) ** 2
        v: Any = np.float64(voltage[i])
        now, events = 0.0, written
        address = event_address(first_pixel + i, width, 1.0 / width)
        while True:
            up, down = max(above[i] - v, 0.0), max(below[i] + v, 0.0)
            state, u = uniform(state)
            on = u < on_probability(mu, sigma2, up, down)
            distance = up if on else down
            tau = 0.0 if distance == 0.0 else np.inf
            if sigma2 > 0.0 and 0.0 < distance < np.inf:
                state, tau = inverse_gaussian(state, abs(mu) / distance, distance * distance / sigma2)
            elif mu != 0.0:
                tau = distance / abs(mu)
            if tau == np.inf:  # nothing moves it, or a dead pixel
                break
            if now + tau >= span_us:
                v += (distance if on else -distance) * (span_us - now) / tau
                break
            if events == keys.shape[0]:
                return i, written
            now += tau
            keys[events] = event_key(offset_us + now, address, 1 if on else -1)
            events += 1
            v = 0.0
        written = events
        voltage[i] = v
    return voltage.shape[0], written
