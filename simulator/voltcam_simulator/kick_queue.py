"""Kicks on their way to pixels: a heap, the next one first (Williams 1964).

An array (room, 3) float64 of which the first so many rows are kicks: when due [us], pixel, size.
"""

import math
from typing import Any

import numpy as np

from .kernel import kernel
from .random import normal, sequence, uniform

_LN_10 = math.log(10.0)


@kernel
def send(
    queue: Any, queued: Any, rule: Any, key: Any, t: Any, pixel: Any, side: Any, width: Any, height: Any
) -> Any:
    """(queue, larger where it was full, and how many are in it) with what a `KickRule` makes of an event.

    What is drawn depends on the event alone, so that no cut of time into intervals changes it.
    """
    size = rule.after_on if side > 0 else rule.after_off
    if size == 0.0:
        return queue, queued
    state = sequence(key, np.uint64(t) * np.uint64(width * height) + np.uint64(pixel))
    for k in range(rule.targets.shape[0]):
        state, u = uniform(state)
        state, gauss = normal(state)
        x, y = pixel % width + rule.targets[k, 0], pixel // width + rule.targets[k, 1]
        if u >= rule.chance or x < 0 or x >= width or y < 0 or y >= height:
            continue
        delay = rule.delay_us * math.exp(_LN_10 * rule.spread_decades * gauss)
        queue, queued = push(queue, queued, t + math.floor(delay + 0.5), y * width + x, size)
    return queue, queued


@kernel
def push(queue: Any, queued: Any, due: Any, pixel: Any, size: Any) -> Any:
    """(queue, how many are in it) with one more."""
    if queued == queue.shape[0]:
        longer = np.empty((2 * queued, 3))
        longer[:queued] = queue
        queue = longer
    place = queued
    while place > 0 and queue[(place - 1) // 2, 0] > due:
        queue[place] = queue[(place - 1) // 2]
        place = (place - 1) // 2
    queue[place, 0], queue[place, 1], queue[place, 2] = due, pixel, size
    return queue, queued + 1


@kernel
def pop(queue: Any, queued: Any) -> Any:
    """How many there are when the first is taken out."""
    queued -= 1
    due, pixel, size = queue[queued, 0], queue[queued, 1], queue[queued, 2]
    place = 0
    while 2 * place + 1 < queued:
        child = 2 * place + 1
        if child + 1 < queued and queue[child + 1, 0] < queue[child, 0]:
            child += 1
        if queue[child, 0] >= due:
            break
        queue[place] = queue[child]
        place = child
    queue[place, 0], queue[place, 1], queue[place, 2] = due, pixel, size
    return queued
