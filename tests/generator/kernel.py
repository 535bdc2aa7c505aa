"""The pixels, step by step: everything compiled is here, in one file, so that numba's cache sees every edit.

Euler-Maruyama, with the step cut in PARTS where the voltage comes within reach of a threshold (DOUBT standard
deviations of the step's noise beyond its drift): there a crossing is looked for after each part, and put in
time on the straight line through it. The overshoot over a threshold is carried over to the next interval, so
that the mean number of events is that of continuous time; what remains of the finite part h (6.25 us by
default) is that a crossing is seen late by .58 sigma sqrt(h)/mu (Broadie, Glasserman and Kou 1997), at both
ends of an interval alike: 40 us for the leak of the DAVIS346 at 128 DN, .7/s, intervals scattering by 28 ms.
"""

from typing import Any

import numpy as np
from numba import njit

FINENESS = 4  # samples of the texture per pixel, so that straight lines between them are smooth light
PARTS = 32
DOUBT = 5.5
PER_DN = 4  # entries per DN of the tables over radiance
TABLE = 320 * PER_DN + 2


@njit
def _place(light):  # type: ignore[no-untyped-def]
    """Entry of the tables below this radiance, and the share of the next one."""
    at = min(max(light, 0.0) * PER_DN, TABLE - 2.0)
    return int(at), at - int(at)


@njit(cache=True, nogil=True)
def _expose(pose, canvas, picture):  # type: ignore[no-untyped-def]
    """DN of each pixel: a card, else a disc with an edge of one pixel, else texture times shading.

    Bodies of the loops over pixels call no function with arrays: counting their references cost 60 ns each.
    """
    texture, shading, card, disc_dn, disc_radius, disc_print = canvas
    (height, width), last = card.shape, texture.shape[0] - 1
    prints, end = disc_print.shape[0], disc_print.shape[1] - 1
    for y in range(height):
        for x in range(width):
            if card[y, x] >= 0:
                picture[y, x] = card[y, x]
                continue
            dx, dy = x - width / 2, y - height / 2
            u = FINENESS * (pose[0] + pose[2] * dx - pose[3] * dy)
            w = FINENESS * (pose[1] + pose[3] * dx + pose[2] * dy)
            i, j = int(np.floor(u)), int(np.floor(w))
            a, b = u - i, w - j
            upper = texture[j & last, i & last] * (1 - a) + texture[j & last, (i + 1) & last] * a
            lower = texture[(j + 1) & last, i & last] * (1 - a) + texture[(j + 1) & last, (i + 1) & last] * a
            light = shading[y, x] * (upper * (1 - b) + lower * b)
            for d in range(disc_dn.size):
                ex, ey, reach = x - pose[4 + 2 * d], y - pose[5 + 2 * d], disc_radius[d] + 0.5
                square = ex * ex + ey * ey
                if square < reach * reach:
                    inside = min(reach - np.sqrt(square), 1.0)
                    i, j = int(np.floor(FINENESS * ex)), int(np.floor(FINENESS * ey))
                    a, b, k = FINENESS * ex - i, FINENESS * ey - j, min(d, prints - 1)
                    upper = (
                        disc_print[k, j & end, i & end] * (1 - a) + disc_print[k, j & end, (i + 1) & end] * a
                    )
                    j += 1
                    lower = (
                        disc_print[k, j & end, i & end] * (1 - a) + disc_print[k, j & end, (i + 1) & end] * a
                    )
                    own = disc_dn[d] * (upper * (1 - b) + lower * b)
                    light += inside * inside * (3 - 2 * inside) * (own - light)
            picture[y, x] = light


@njit(cache=True, nogil=True)
def paint(poses: Any, canvas: Any) -> Any:
    """(times, height, width) float32 DN."""
    picture = np.empty((poses.shape[0], *canvas.card.shape), np.float32)
    for n in range(poses.shape[0]):
        _expose(poses[n], canvas, picture[n])
    return picture


@njit(cache=True, nogil=True)
def _drive(picture, light_factor, junction_factor, dt, numbers, tables, maps, state):  # type: ignore[no-untyped-def]
    """The photoreceptor's output and the leaks: what moves the voltages over this step."""
    lights, logs, slow, slower, moved = state.light, state.log, state.slow, state.slower, state.moved
    leak, cutoff = tables.leak_per_us, tables.cutoff_per_us
    junction, drift = maps.junction_per_us, maps.drift_per_us
    follow = 1 - np.exp(-dt * numbers.follower_per_us)
    height, width = moved.shape
    for y in range(height):
        for x in range(width):
            light = picture[y, x] * light_factor
            if light != lights[y, x]:
                lights[y, x], logs[y, x] = light, np.log(light + numbers.k2)
            low, share = _place(light)
            before = slower[y, x]
            if numbers.follower_per_us > 0:
                rate = cutoff[low] + share * (cutoff[low + 1] - cutoff[low])
                slow[y, x] += (1 - np.exp(-dt * rate)) * (logs[y, x] - slow[y, x])
                slower[y, x] += follow * (slow[y, x] - before)
            else:
                slower[y, x] = logs[y, x]
            change = slower[y, x] - before
            change /= 1 + abs(change) / (numbers.slew_per_us * dt)
            rate = leak[low] + share * (leak[low + 1] - leak[low])
            rate += junction[y, x] * junction_factor + drift[y, x]
            moved[y, x] = numbers.k1 * change + rate * dt


@njit(cache=True, nogil=True)
def _remember(dt, numbers, state, rng):  # type: ignore[no-untyped-def]
    """What moves voltages or thresholds because of what was: rebounds, tired thresholds, coloured noise."""
    back = np.exp(-dt / numbers.rebound_us)
    state.moved[:] += (1 - back) * state.rebound
    state.rebound[:] *= back
    state.tired[:] *= np.exp(-dt / numbers.tiring_us)
    if numbers.hum == 0:
        return
    light, hum, humming, moved = state.light, state.hum, state.humming, state.moved
    keep = np.exp(-dt / numbers.hum_us)
    height, width = moved.shape
    for y in range(height):
        for x in range(width):
            humming[y, x] = keep * humming[y, x] + np.sqrt(1 - keep * keep) * rng.standard_normal()
            change = (1 - keep) * (humming[y, x] - hum[y, x])
            hum[y, x] += change
            moved[y, x] += numbers.hum * np.sqrt(2 * 50 / (50 + light[y, x])) * change


@njit(cache=True, nogil=True)
def _fire(y, x, sign, t, rest, hold, numbers, maps, state, rng):  # type: ignore[no-untyped-def]
    """The pixel's own consequences of an event, and its neighbours'. rest: what is left of the voltage."""
    state.v[y, x] = rest if hold == 0 else 0.0
    if numbers.reset_sigma > 0:
        spread = numbers.reset_sigma * rng.standard_normal()
        state.v[y, x] += min(max(spread, -0.8 * maps.theta_off[y, x]), 0.8 * maps.theta_on[y, x])
    state.dead_us[y, x] = t + hold
    state.rebound[y, x] -= sign * numbers.rebound
    state.tired[y, x] += numbers.tiring
    if numbers.crosstalk != 0:
        height, width = state.v.shape
        for dy, dx in ((-1, 0), (1, 0), (0, -1), (0, 1)):
            if 0 <= y + dy < height and 0 <= x + dx < width and state.dead_us[y + dy, x + dx] < t:
                state.v[y + dy, x + dx] += sign * numbers.crosstalk


@njit(cache=True, nogil=True)
def _closely(  # type: ignore[no-untyped-def]
    y, x, t0, dt, noise, kick, kick_at, hold, theta, numbers, maps, state, rng, events, used
):
    """One step of one pixel in PARTS: writes (t, x, y, sign) of its events, returns how many there are."""
    part, moved, v, dead_us = dt / PARTS, state.moved[y, x] / PARTS, state.v, state.dead_us
    on, off = theta * maps.theta_on[y, x], -theta * maps.theta_off[y, x]
    for i in range(PARTS):
        start = t0 + i * part
        alive = min(max((start + part - dead_us[y, x]) / part, 0.0), 1.0)
        if alive == 0:
            continue
        before = v[y, x]
        after = before + alive * moved + noise * np.sqrt(alive / PARTS) * rng.standard_normal()
        struck = kick != 0 and start <= kick_at < start + part and alive == 1
        if struck:
            after += kick
        v[y, x] = after
        if off < after < on:
            continue
        sign, level = (1, on) if after >= on else (-1, off)
        share = 1.0 if after == before else min(max((level - before) / (after - before), 0.0), 1.0)
        t = kick_at if struck else start + part * (1 - alive + alive * share)
        events[used, 0], events[used, 1], events[used, 2], events[used, 3] = t, x, y, sign
        used += 1
        _fire(y, x, sign, t, after - level, hold, numbers, maps, state, rng)
    return used


@njit(cache=True, nogil=True)
def _room(events, used, needed):  # type: ignore[no-untyped-def]
    if used + needed <= events.shape[0]:
        return events
    larger = np.empty((2 * events.shape[0] + needed, 4))
    larger[:used] = events[:used]
    return larger


@njit(cache=True, nogil=True)
def _next_kick(y, t0, dt, next_frame, kick_us, numbers):  # type: ignore[no-untyped-def]
    """(size, time) of the kick of this row within this step, 0 for none; there is one at most."""
    for n in range(max(next_frame - 4, 0), min(next_frame + 2, kick_us.shape[0])):
        if t0 <= kick_us[n, 0] < t0 + dt:
            return numbers.kick, kick_us[n, 0]
        readout = kick_us[n, 1] + y * numbers.row_us
        if t0 <= readout < t0 + dt:
            return -2 * numbers.kick, readout
        if t0 <= readout + numbers.pulse_us < t0 + dt:
            return numbers.kick, readout + numbers.pulse_us
    return 0.0, 0.0


@njit(cache=True, nogil=True)
def _compare(  # type: ignore[no-untyped-def]
    t0, dt, theta_factor, next_frame, kick_us, numbers, tables, maps, state, rng, events, used
):
    """Adds this step's drift, kicks and noise to the voltages, and looks closely where that may cross."""
    v, light, dead_us, moved, tired = state.v, state.light, state.dead_us, state.moved, state.tired
    sigma, refractory, theta_on, theta_off = tables.sigma, tables.refractory_us, maps.theta_on, maps.theta_off
    root, (height, width) = np.sqrt(dt), v.shape
    for y in range(height):
        kick, kick_at = _next_kick(y, t0, dt, next_frame, kick_us, numbers)
        for x in range(width):
            if dead_us[y, x] >= t0 + dt:
                continue
            low, share = _place(light[y, x])
            noise = (sigma[low] + share * (sigma[low + 1] - sigma[low])) * root
            theta = theta_factor * (1 + tired[y, x])
            reach = abs(moved[y, x]) + abs(kick) + DOUBT * noise
            within = v[y, x] + reach < theta * theta_on[y, x] and v[y, x] - reach > -theta * theta_off[y, x]
            if within and dead_us[y, x] <= t0:
                v[y, x] += moved[y, x] + kick + noise * rng.standard_normal()
            else:
                hold = refractory[low] + share * (refractory[low + 1] - refractory[low])
                used = _closely(
                    y, x, t0, dt, noise, kick, kick_at, hold, theta, numbers, maps, state, rng, events, used
                )
    return used


@njit(cache=True, nogil=True)
def run(
    t_start: Any, dt: Any, poses: Any, canvas: Any, factors: Any, kick_us: Any,
    numbers: Any, tables: Any, maps: Any, state: Any, rng: Any,
) -> Any:  # fmt: skip
    """(events, 4) float64: t [us], x, y, sign, by step, unsorted within it.

    poses: (steps, ...) at the steps' ends; factors: (steps, 3), on the radiance, the junction leak and the
    thresholds; kick_us: (frames, 2), exposure starts, readout of row 0, sorted; state is left as at the end.
    """
    picture = np.empty(state.v.shape, np.float32)
    events, used, next_frame = np.empty((65536, 4)), 0, 0
    for n in range(len(poses)):
        t0 = t_start + n * dt
        while next_frame < len(kick_us) and kick_us[next_frame, 0] < t0:
            next_frame += 1
        _expose(poses[n], canvas, picture)
        _drive(picture, factors[n, 0], factors[n, 1], dt, numbers, tables, maps, state)
        if numbers.rebound != 0 or numbers.tiring != 0 or numbers.hum != 0:
            _remember(dt, numbers, state, rng)
        events = _room(events, used, picture.size * PARTS)
        used = _compare(
            t0, dt, factors[n, 2], next_frame, kick_us, numbers, tables, maps, state, rng, events, used
        )
    return events[:used]
