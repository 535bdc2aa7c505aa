"""Paths of pixels through an interval that they have gone through without kicks, followed again with them.

A path is straight from what is known of it to what is known next, which is the voltage at both ends of the
interval, the threshold at each event and 0 behind it. So kicks act as they do in a pixel without noise,
however time is cut into intervals; what the noise does between two instants that are known is left out.
"""

from typing import Any, NamedTuple

import numpy as np

from .kernel import kernel

FULL = 0.999
"""Of a threshold: the most that a voltage is left at."""


class KickedPaths(NamedTuple):
    """Of each pixel in an interval: what it would do without kicks, and what it does; (pixels,) each."""

    following: Any
    """int64, number of its next event without kicks; -1: none."""
    knot_us: Any
    """float64, from when its path without kicks is straight to the next event or the end..."""
    knot: Any
    """...and where it is until then."""
    end: Any
    """Its voltage without kicks at the end of the interval."""
    offset: Any
    """Its voltage less that without kicks."""
    last_us: Any
    """int64, time of its last event."""
    now_us: Any
    """float64, up to when it has been followed."""


@kernel
def paths_of(events: Any, start: Any, voltage: Any, before: Any, last: Any, dead: Any, width: Any) -> Any:
    """(KickedPaths at the start of an interval, (n,) the number of the same pixel's next event)."""
    pixels, n = voltage.shape[0], events.shape[0]
    following, later = np.full(pixels, -1), np.empty(n, np.int64)
    for i in range(n - 1, -1, -1):
        pixel = np.int64(events[i].y) * width + np.int64(events[i].x)
        later[i], following[pixel] = following[pixel], i
    knot_us, knot, end = np.empty(pixels), np.empty(pixels), np.empty(pixels)
    for pixel in range(pixels):
        knot_us[pixel] = max(np.float64(start), last[pixel] + dead)
        end[pixel] = voltage[pixel]
        knot[pixel] = before[pixel]
        if np.isnan(before[pixel]):
            knot[pixel] = 0.0 if following[pixel] >= 0 else end[pixel]
    now = np.full(pixels, np.float64(start))
    return KickedPaths(following, knot_us, knot, end, np.zeros(pixels), last, now), later


@kernel
def without_kicks(paths: Any, pixel: Any, t: Any, events: Any, end: Any, on: Any, off: Any) -> Any:
    """Where the pixel would be at a time not behind its next event, before the reset of that."""
    i = paths.following[pixel]
    at, level = np.float64(end), paths.end[pixel]
    if i >= 0:
        at, level = np.float64(events[i].t), np.float64(on if events[i].p else -off)
    since = paths.knot_us[pixel]
    if t >= at:
        return level
    if t <= since:
        return paths.knot[pixel]
    return paths.knot[pixel] + (level - paths.knot[pixel]) * (t - since) / (at - since)


@kernel
def next_event(paths: Any, pixel: Any, events: Any, end: Any, on: Any, off: Any, dead: Any) -> Any:
    """(sign, time) of the next event of a pixel that was kicked, up to the next one that it would have had
    without; 0: none until then."""
    i, now, offset = paths.following[pixel], paths.now_us[pixel], paths.offset[pixel]
    until = np.float64(events[i].t if i >= 0 else end)
    free = np.float64(paths.last_us[pixel] + dead)
    if free >= until and dead > 0.0:
        return 0, until
    if free > now:  # held at 0: what moves the pixel meanwhile is lost
        now, offset = free, -without_kicks(paths, pixel, free, events, end, on, off)
    now = min(max(now, paths.knot_us[pixel]), until)
    begin = without_kicks(paths, pixel, now, events, end, on, off) + offset
    level = without_kicks(paths, pixel, until, events, end, on, off) + offset
    if level >= on:
        return 1, now + max((on - begin) / (level - begin) if level > begin else 0.0, 0.0) * (until - now)
    if level <= -off:
        return -1, now + max((off + begin) / (begin - level) if level < begin else 0.0, 0.0) * (until - now)
    return 0, until


@kernel
def follow_to(paths: Any, pixel: Any, t: Any, events: Any, end: Any, on: Any, off: Any, dead: Any) -> Any:
    """Follow a pixel to its next event that it would not have had then, or to t: the event's sign, or 0."""
    now = paths.now_us[pixel]
    if paths.offset[pixel] != 0.0 and now <= t:
        side, at = next_event(paths, pixel, events, end, on, off, dead)
        if side != 0 and at <= t:
            fire(paths, pixel, at, events, end, on, off)
            return side
        free = min(np.float64(paths.last_us[pixel] + dead), t)
        if free > now:
            paths.offset[pixel] = -without_kicks(paths, pixel, free, events, end, on, off)
    paths.now_us[pixel] = max(now, t)
    return 0


@kernel
def fire(paths: Any, pixel: Any, t: Any, events: Any, end: Any, on: Any, off: Any) -> None:
    """An event of the pixel that it would not have had then: its voltage is 0 behind it."""
    paths.offset[pixel] = -without_kicks(paths, pixel, t, events, end, on, off)
    paths.now_us[pixel], paths.last_us[pixel] = t, np.int64(t)


@kernel
def kick(
    paths: Any, pixel: Any, t: Any, size: Any, events: Any, end: Any, on: Any, off: Any, dead: Any
) -> Any:
    """Kick a pixel that was followed to t: the sign of the event that this sets off, or 0."""
    if paths.last_us[pixel] + dead > t + 1 or on == np.inf:
        return 0  # held, or dead: the events it still has are of before
    raised = without_kicks(paths, pixel, t, events, end, on, off) + paths.offset[pixel] + size
    if -off < raised < on:
        paths.offset[pixel] += size
        return 0
    fire(paths, pixel, t, events, end, on, off)
    return 1 if raised > 0 else -1


@kernel
def pass_event(
    paths: Any, pixel: Any, t: Any, side: Any, following: Any, on: Any, off: Any, dead: Any
) -> Any:
    """Let a pixel, followed to t, go by an event that it would have had without kicks: whether it has it."""
    paths.following[pixel] = following
    paths.knot_us[pixel], paths.knot[pixel] = t + dead, 0.0
    if t - paths.last_us[pixel] + 1 < dead:  # times are whole microseconds
        paths.offset[pixel] = 0.0
        return False
    if paths.offset[pixel] == 0.0:
        paths.last_us[pixel] = t
        return True
    paths.offset[pixel] += on if side > 0 else -off
    return False


@kernel
def take_ends(paths: Any, theta_on: Any, theta_off: Any, voltage: Any, before: Any) -> None:
    """Voltages at the end of the interval, to voltage and before, (pixels,) each."""
    width = theta_on.shape[1]
    for k in range(voltage.shape[0]):
        if paths.offset[k] != 0.0:
            on, off = theta_on[k // width, k % width], theta_off[k // width, k % width]
            voltage[k] = min(max(paths.end[k] + paths.offset[k], -FULL * off), FULL * on)
        before[k] = voltage[k]
