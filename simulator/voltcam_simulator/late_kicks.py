"""Voltages that are kicked some time after events, of the same pixel or of others.

The pixels have gone through an interval without these kicks. Where one comes, the pixel's path is followed
again from there, see `kicked_paths`: so an event comes earlier or later, comes in addition or does not come.
"""

from typing import Any, NamedTuple

import numpy as np

from .effect import EventInterval, Events, Sensor, State
from .event_order import in_time_order
from .kernel import kernel
from .kick_queue import pop, push, send
from .kicked_paths import follow_to, kick, next_event, pass_event, paths_of, take_ends
from .random import events_key

LONG_AGO_US = -(2**62)
MOST_STEPS = 1 << 16
"""Of a walk at once: some 10 ms. Between two of these the interval may be given up."""
OWN = np.array([[0, 0]])
NEIGHBOURS = np.array([[-1, 0], [1, 0], [0, -1], [0, 1]])


class KickRule(NamedTuple):
    """What an event leads to; voltages in nominal thresholds."""

    after_on: Any
    """Size of a kick after an ON event..."""
    after_off: Any
    """...and after an OFF event."""
    chance: Any
    """Of a kick."""
    delay_us: Any
    """From the event to the kick, in the median."""
    spread_decades: Any
    """Standard deviation of the delay's decimal logarithm."""
    targets: Any
    """(m, 2) int64: the pixels that get one, as steps in x and y."""


class Walk(NamedTuple):
    """How far an interval has been followed."""

    queue: Any
    """The kicks on their way, a `kick_queue`..."""
    queued: Any
    """...and how many."""
    out: Any
    """Space for events with kicks, in no order..."""
    written: Any
    """...and how many."""
    clock_us: Any
    """Up to when."""
    passed: Any
    """How many of the events without kicks are behind."""
    ended: Any
    """How many pixels have come to the end."""


def late_kick_state(sensor: Sensor) -> State:
    """What an effect of this kind keeps: when each pixel fired last, its voltage at the last interval's end
    (NaN: not known), and the kicks on their way, a `kick_queue`."""
    pixels = sensor.width * sensor.height
    return {
        "last_us": np.full(pixels, LONG_AGO_US, np.int64),
        "before": np.full(pixels, np.nan),
        "waiting": np.empty((0, 3)),
    }


def kicked(name: str, rule: KickRule, events: Events, interval: EventInterval) -> Events:
    """The events of an interval with kicks by this rule, sorted; changes the voltages at its end.

    Raises GivenUpError, with the voltages as they were.
    """
    sensor, state = interval.sensor, interval.state[name]
    width, last_us = sensor.width, state["last_us"]
    theta_on, theta_off = np.ascontiguousarray(sensor.theta_on), np.ascontiguousarray(sensor.theta_off)
    paths, later = paths_of(
        events, interval.start_us, interval.voltage, state["before"], last_us, sensor.refractory_us, width
    )
    key = events_key(sensor.seed, name, 0)
    walk = start_of_walk(events, interval.start_us, state["waiting"])
    is_over = False
    while not is_over:
        interval.admit(max(walk.written, walk.queued))
        walk, is_over = follow_kicks(
            events, interval.end_us, rule, key, theta_on, theta_off, sensor.refractory_us, paths, later, walk,
            MOST_STEPS,
        )  # fmt: skip
    take_ends(paths, theta_on, theta_off, interval.voltage, state["before"])
    state["waiting"] = walk.queue[: walk.queued].copy()
    return in_time_order(walk.out[: walk.written])


@kernel
def start_of_walk(events: Any, start: Any, waiting: Any) -> Any:
    """A walk before its first step; waiting (m, 3): a kick queue."""
    queue, queued = np.empty((max(16, 2 * waiting.shape[0]), 3)), waiting.shape[0]
    queue[:queued] = waiting
    return Walk(queue, queued, np.empty(2 * events.shape[0] + 16, events.dtype), 0, np.float64(start), 0, 0)


@kernel
def follow_kicks(
    events: Any, end: Any, rule: Any, key: Any, theta_on: Any, theta_off: Any, dead: Any, paths: Any,
    later: Any, walk: Any, most: Any,
) -> Any:  # fmt: skip
    """(Walk, at most so many steps further; whether it is over). Changes the paths.

    theta_on, theta_off (height, width); dead: time [us]; later (n,): see `paths_of`.
    """
    (height, width), n = theta_on.shape, events.shape[0]
    queue, queued, out, written = walk.queue, walk.queued, walk.out, walk.written
    clock, i, ended = walk.clock_us, walk.passed, walk.ended
    for _ in range(most):
        until, size = events[i].t if i < n else end, 0.0
        while i == n and ended < width * height and paths.offset[ended] == 0.0:
            ended += 1
        is_kick = queued > 0 and queue[0, 0] <= until
        if is_kick:
            clock, pixel, size = max(clock, queue[0, 0]), np.int64(queue[0, 1]), queue[0, 2]
            queued = pop(queue, queued)
        elif i < n:
            clock, pixel = np.float64(until), np.int64(events[i].y) * width + np.int64(events[i].x)
        elif ended < width * height:
            clock, pixel = np.float64(end), np.int64(ended)
            ended += 1
        else:
            return Walk(queue, queued, out, written, clock, i, ended), True
        on, off = theta_on[pixel // width, pixel % width], theta_off[pixel // width, pixel % width]
        while True:
            side = follow_to(paths, pixel, clock, events, end, on, off, dead)
            if side == 0:
                break
            out, written = add(out, written, paths.last_us[pixel], pixel, side, width)
            queue, queued = send(queue, queued, rule, key, paths.last_us[pixel], pixel, side, width, height)
        if is_kick:
            side = kick(paths, pixel, clock, size, events, end, on, off, dead)
            if side != 0:  # what a kick sets off does not kick in its turn
                out, written = add(out, written, paths.last_us[pixel], pixel, side, width)
        elif i < n:
            side = 1 if events[i].p else -1
            if pass_event(paths, pixel, events[i].t, side, later[i], on, off, dead):
                out, written = add(out, written, events[i].t, pixel, side, width)
                queue, queued = send(queue, queued, rule, key, events[i].t, pixel, side, width, height)
            i += 1
        if paths.offset[pixel] != 0.0:
            side, at = next_event(paths, pixel, events, end, on, off, dead)
            if side != 0:
                queue, queued = push(queue, queued, at, pixel, 0.0)  # nothing but a look then
    return Walk(queue, queued, out, written, clock, i, ended), False


@kernel
def add(out: Any, written: Any, t: Any, pixel: Any, side: Any, width: Any) -> Any:
    """(Space for events, larger where it was full, and how many are in it) with one more."""
    if written == out.shape[0]:
        longer = np.empty(2 * written, out.dtype)
        longer[:written] = out
        out = longer
    out[written].t, out[written].x, out[written].y = t, pixel % width, pixel // width
    out[written].p = side > 0
    return out, written + 1
