r"""Waiting times: under still light the next event of a pixel is drawn ahead, and until then nothing is done.

While the light on a pixel stands still its drift mu and noise sigma are constant. It will never reach the
threshold behind it, g away, but with probability exp(-2 |mu| g / sigma^2). Where that is below `MISS`, the
time to the threshold ahead, d away, is inverse Gaussian:

    T ~ IG(mean d / |mu|, shape d^2 / sigma^2)

When the light moves on s after the start, before T, the voltage there is drawn given T. A Brownian motion
known to reach the threshold at T for the first time is, seen from the threshold, the distance from the origin
of a Brownian bridge in space from (d, 0, 0) to the origin (the Bessel bridge; mu no longer appears):

    R^2 = (d (1 - s/T) + q N1)^2 + (q N2)^2 + (q N3)^2,    q^2 = sigma^2 s (1 - s/T)

Both steps are exact. References: Borodin and Salminen, Handbook of Brownian Motion (2002), part II, for the
time; Williams, Proc. London Math. Soc. 28 (1974) 738, and Revuz and Yor (1999), chapter XI, for the bridge.

What a row needs while it is ahead is in `AheadRows`; its `Pixels.voltage` is where it was at drawn_us. Times
count from an epoch.
"""

import math
from typing import Any

import numpy as np

from .event_key import event_address, event_key
from .first_passage import LOG_MISS, inverse_gaussian
from .kernel import kernel
from .out_of_reach import REACH
from .random import normals, sequences, uniforms

BLOCK = 512
STILL_STEPS = 8
"""Steps without change before a row is drawn ahead: what drawing ahead and catching up cost, about."""


@kernel
def count_still_steps(before: Any, after: Any, still_steps: Any) -> Any:
    """still_steps (rows,): after how many steps without change two frames (rows, bytes) are the same, or 0.

    Returns (how many rows change, most steps).
    """
    changed, most = 0, 0
    for row in range(still_steps.shape[0]):
        differences = np.uint8(0)
        for i in range(before.shape[1]):
            differences |= before[row, i] ^ after[row, i]
        still_steps[row] = 0 if differences else still_steps[row] + 1
        changed += still_steps[row] == 0
        most = max(most, still_steps[row])
    return changed, most


@kernel
def inverse_gaussians(gauss: Any, u: Any, distance: Any, mu: Any, sigma: Any, times: Any) -> None:
    """times (m,) from IG(distance/|mu|, (distance/sigma)^2), by a normal and a uniform number; inf: never.

    The two roots of Michael, Schucany and Haas, d^2/r and r/mu^2, as in `first_passage.inverse_gaussian`.
    """
    for k in range(times.shape[0]):
        speed, d = abs(mu[k]), distance[k]
        c, q = speed * d, 0.5 * (gauss[k] * sigma[k]) ** 2
        r = c + q + math.sqrt(q * (q + 2.0 * c))
        time = d * d / r if u[k] * (r + c) <= r else r / (speed * speed)
        times[k] = time if time < np.inf else np.inf  # a dead pixel has no number here


@kernel
def draw_ahead(
    still_steps: Any, ahead: Any, drawn_us: Any, since_us: Any, due_us: Any, motion: Any,
    voltage: Any, pending: Any, held: Any, above: Any, below: Any, drift: Any, noise: Any,
    key: Any, span_us: Any, offset_us: Any, first_pixel: Any, width: Any, now: Any,
) -> Any:  # fmt: skip
    """Draw the next event in rows under still light whose pixels have one threshold in reach each.

    Called as draw_ahead(*rows, *pixels, *motion, *step, now), see `groups`: the step ends now [us].
    Returns how many rows these are.
    """
    drawn = 0
    per_span = 1.0 / span_us
    states, places = np.empty(width, np.uint64), np.arange(width, dtype=np.int32)
    gauss, other, u, distance = np.empty(width), np.empty(width), np.empty(width), np.empty(width)
    mu, sigma = np.empty(width), np.empty(width)
    for row in range(ahead.shape[0]):
        here = slice(row * width, row * width + width)
        v, p, a, b = voltage[here], pending[here], above[here], below[here]
        since, due, constant = since_us[here], due_us[here], motion[here]
        if (
            ahead[row]
            or still_steps[row] < STILL_STEPS
            or not one_threshold(v, p, a, b, drift[here], noise[here], per_span)
        ):
            continue
        sequences(key, first_pixel + row * width, places, states)
        normals(states, gauss, other)
        uniforms(states, u)
        for k in range(width):
            mu[k], sigma[k] = drift[row * width + k] * per_span, noise[row * width + k]
            v[k] += math.sqrt(p[k]) * gauss[k]
            distance[k] = max(a[k] - v[k] if mu[k] >= 0.0 else v[k] + b[k], 0.0)
        inverse_gaussians(other, u, distance, mu, sigma, gauss)
        for k in range(width):
            constant[k, 0], constant[k, 1] = mu[k], sigma[k]
            since[k], due[k] = now, now + max(gauss[k], 1.0)  # a stamp is whole microseconds, too
        ahead[row], drawn_us[row] = True, now
        drawn += 1
    return drawn


@kernel
def one_threshold(
    voltage: Any, pending: Any, above: Any, below: Any, drift: Any, noise: Any, per_span: Any
) -> Any:
    """True when every pixel drifts to one threshold and cannot reach the other one, now or after a reset.

    With pending variance p the mean of exp(-2 mu g / sigma^2) is that of a gap less by mu p / sigma^2.
    """
    short = 0
    for i in range(voltage.shape[0]):
        mu, s = abs(drift[i] * per_span), np.float64(noise[i])
        behind = below[i] if drift[i] >= 0.0 else above[i]
        gap = voltage[i] + below[i] if drift[i] >= 0.0 else above[i] - voltage[i]
        gap -= mu * pending[i] / (s * s) if s > 0.0 else REACH * math.sqrt(pending[i])
        gap = min(gap, behind)
        short += (2.0 * mu * gap < -LOG_MISS * s * s) | (gap <= 0.0)
    return short == 0


@kernel
def find_due(ahead: Any, due: Any, end: Any, found: Any) -> Any:
    """Fill found (n + 1,) with the pixels of rows ahead that are due before end; returns their number.

    Few are: they are looked for eight at a time.
    """
    width, count = due.shape[0] // ahead.shape[0], 0
    soon = np.zeros((width + 7) // 8 * 8, np.bool_)
    eights = soon.view(np.uint64)
    some = np.empty(eights.size + 1, np.int32)
    for row in range(ahead.shape[0]):
        if not ahead[row]:
            continue
        times = due[row * width : row * width + width]
        for k in range(width):
            soon[k] = times[k] < end
        found_eights = 0
        for eight in range(eights.shape[0]):
            some[found_eights] = 8 * eight
            found_eights += eights[eight] != 0
        for eight in some[:found_eights]:
            for k in range(eight, eight + 8):
                found[count] = row * width + k
                count += soon[k]
    return count


@kernel
def draw_due(
    since: Any, due: Any, motion: Any, above: Any, below: Any, key: Any, span_us: Any, offset_us: Any,
    first_pixel: Any, width: Any, now: Any, found: Any, first: Any, count: Any, keys: Any,
) -> Any:  # fmt: skip
    """Pack the events of the pixels found[first:count] in a step that starts now [us]; draw the next ones.

    The planes are fields of `AheadRows` and `Pixels`; the five after them those of `Step`.
    Returns (pixels done, events written), see `crossings.cross`.
    """
    written, per_width, end = 0, 1.0 / width, now + span_us
    states = np.empty(BLOCK, np.uint64)
    gauss, other, u = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK)
    mu, sigma, threshold = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK)
    last, wait = np.empty(BLOCK), np.empty(BLOCK)
    for begin in range(first, count, BLOCK):
        block = found[begin : min(begin + BLOCK, count)]
        n, done = block.shape[0], written
        sequences(key, first_pixel, block, states)
        normals(states[:n], gauss[:n], other[:n])
        uniforms(states, u[:n])
        for k in range(n):
            i = block[k]
            mu[k], sigma[k], last[k] = motion[i, 0], motion[i, 1], due[i]
            threshold[k] = above[i] if mu[k] >= 0.0 else below[i]
        inverse_gaussians(gauss, u, threshold, mu, sigma, wait[:n])
        if done + n > keys.shape[0]:
            return begin, written
        for k in range(n):
            address = event_address(first_pixel + block[k], width, per_width)
            keys[done + k] = event_key(offset_us + (last[k] - now), address, mu[k])
        done += n
        for k in range(n):
            while last[k] + wait[k] < end:  # once more in the same step
                if done == keys.shape[0]:
                    return begin, written
                last[k] += wait[k]
                address = event_address(first_pixel + block[k], width, per_width)
                keys[done] = event_key(offset_us + (last[k] - now), address, mu[k])
                done += 1
                d = threshold[k]
                states[k], wait[k] = inverse_gaussian(states[k], abs(mu[k]) / d, (d / sigma[k]) ** 2)
        for k in range(n):
            i = block[k]
            since[i], due[i] = last[k], last[k] + wait[k]
        written = done
    return count, written


@kernel
def catch_up(
    still_steps: Any, ahead: Any, drawn_us: Any, since_us: Any, due_us: Any, motion: Any,
    voltage: Any, pending: Any, held: Any, above: Any, below: Any, key: Any, first_pixel: Any, now: Any,
) -> Any:  # fmt: skip
    """Bring rows that change to the present: their voltages now, given when they would have fired.

    Called as catch_up(*rows, *pixels, key, first_pixel, now), see `groups`. The rows are not ahead any more,
    and nothing of them is pending. Returns how many rows these are.
    """
    woken, width = 0, voltage.shape[0] // ahead.shape[0]
    states, places = np.empty(width, np.uint64), np.arange(width, dtype=np.int32)
    n1, n2, n3, n4 = np.empty(width), np.empty(width), np.empty(width), np.empty(width)
    for row in range(ahead.shape[0]):
        if still_steps[row] > 0 or not ahead[row]:
            continue
        sequences(key, first_pixel + row * width, places, states)
        normals(states, n1, n2)
        normals(states, n3, n4)
        for k in range(width):
            i = row * width + k
            mu, sigma = motion[i, 0], motion[i, 1]
            start = np.float64(voltage[i]) if since_us[i] <= drawn_us[row] else 0.0
            threshold = above[i] if mu >= 0.0 else -below[i]
            passed, left = now - since_us[i], (due_us[i] - now) / max(due_us[i] - since_us[i], 1e-3)
            q = sigma * math.sqrt(passed * left)
            away = abs(threshold - start) * left + q * n1[k]
            rest = math.sqrt(away * away + q * q * (n2[k] * n2[k] + n3[k] * n3[k]))
            voltage[i] = start if due_us[i] == np.inf else threshold - (rest if mu >= 0.0 else -rest)
            pending[i] = 0.0
        ahead[row] = False
        woken += 1
    return woken


@kernel
def shift_epoch(ahead: Any, drawn_us: Any, since_us: Any, due_us: Any, by: Any) -> None:
    """Let the times of rows ahead count from an epoch `by` later, before float32 gets too coarse for them."""
    width = due_us.shape[0] // ahead.shape[0]
    for row in range(ahead.shape[0]):
        if ahead[row]:
            drawn_us[row] -= by
            for i in range(row * width, row * width + width):
                since_us[i] -= by
                due_us[i] -= by
