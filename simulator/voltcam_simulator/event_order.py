"""Arrays of events in order of time: sorted, merged and copied, at a few nanoseconds an event."""

from typing import Any

import numpy as np

from .effect import EVENT, Events
from .kernel import kernel
from .key_order import in_rising_order

MOST_PLACES = 4
"""For each event; with more, going through the empty ones takes longer than a library's sort."""


def in_time_order(events: Events) -> Events:
    """The events sorted by time; those of the same time stay in their order."""
    if len(events) < 2:
        return events
    first_us, last_us = _first_and_last(events)
    if last_us - first_us < MOST_PLACES * len(events):
        counted, places = np.empty_like(events), np.zeros(last_us - first_us + 2, np.int32)
        _by_counting(events, first_us, places, counted)
        return counted
    bits = len(events).bit_length()
    keys, ordered = np.empty(len(events), np.uint64), np.empty_like(events)
    _number(events, np.uint64(bits), keys)
    _take(events, in_rising_order(keys), np.uint64((1 << bits) - 1), ordered)
    return ordered


def copied(events: Events) -> Events:
    """A copy on its own memory; as bytes, since numpy copies records 40 times slower, field by field."""
    return events.view(np.uint8).copy().view(events.dtype)


def merged(first: Events, second: Events) -> Events:
    """Two sorted arrays as one; of events of the same time, the first's come first."""
    if len(first) == 0 or len(second) == 0:
        return first if len(second) == 0 else second
    both = np.empty(len(first) + len(second), EVENT)
    _merge(first, second, first.view(np.uint8), second.view(np.uint8), both.view(np.uint8))
    return both


@kernel
def place_of(events: Any, begin: Any, t: Any) -> Any:
    """The first place from begin on whose event is not before t; all, if there is none.

    In steps that double, then by halves.
    """
    n, step = events.shape[0], 1
    low = begin
    while low + step < n and events[low + step].t < t:
        low, step = low + step, 2 * step
    high = min(low + step, n)
    while low < high:
        middle = (low + high) // 2
        if events[middle].t < t:
            low = middle + 1
        else:
            high = middle
    return low


@kernel
def _first_and_last(events: Any) -> Any:
    """Their times."""
    earliest = latest = events[0].t
    for i in range(events.shape[0]):
        earliest, latest = min(earliest, events[i].t), max(latest, events[i].t)
    return earliest, latest


@kernel
def _by_counting(events: Any, first: Any, places: Any, ordered: Any) -> None:
    """places: a zero for each microsecond from the first event on, and one more."""
    for i in range(events.shape[0]):
        places[events[i].t - first + 1] += 1
    for k in range(1, places.shape[0]):
        places[k] += places[k - 1]
    for i in range(events.shape[0]):
        k = events[i].t - first
        ordered[places[k]] = events[i]
        places[k] += 1


@kernel
def _number(events: Any, bits: Any, keys: Any) -> None:
    """Time since the earliest event, and behind it, in the lowest bits, each event's place."""
    earliest = events[0].t
    for i in range(events.shape[0]):
        earliest = min(earliest, events[i].t)
    for i in range(events.shape[0]):
        keys[i] = (np.uint64(events[i].t - earliest) << bits) | np.uint64(i)


@kernel
def _take(events: Any, keys: Any, mask: Any, ordered: Any) -> None:
    for i in range(keys.shape[0]):
        ordered[i] = events[keys[i] & mask]


@kernel
def _merge(first: Any, second: Any, first_bytes: Any, second_bytes: Any, both: Any) -> None:
    """Runs of events are copied as bytes: one of the two is short as a rule, so that the runs are long."""
    size = both.shape[0] // (first.shape[0] + second.shape[0])
    i, j, to = 0, 0, 0
    while i < first.shape[0] or j < second.shape[0]:
        end = place_of(first, i, second[j].t + 1) if j < second.shape[0] else first.shape[0]
        _copy(first_bytes, i * size, both, to, (end - i) * size)
        to, i = to + (end - i) * size, end
        end = place_of(second, j, first[i].t) if i < first.shape[0] else second.shape[0]
        _copy(second_bytes, j * size, both, to, (end - j) * size)
        to, j = to + (end - j) * size, end


@kernel
def _copy(source: Any, begin: Any, target: Any, to: Any, count: Any) -> None:
    run, room = source[begin : begin + count], target[to : to + count]
    for b in range(count):
        room[b] = run[b]
