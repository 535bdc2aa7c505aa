"""What happens to events between pixels and file. Events are (n, 4) float64: t [us], x, y, sign, by time."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from .effects import Effect
from .wires import Floats, Wires

Parameters = dict[str, float]
Generator = np.random.Generator


def read_out(events: Floats, effect: Effect, wires: Wires, rng: Generator) -> Floats:
    """The events after this effect; as they are where it does not live here."""
    change = READOUT.get(effect.name)
    if change is None:
        return events
    events = change(events, effect.parameters, wires, rng)
    return np.asarray(events[np.argsort(events[:, 0], kind="stable")])


def _some_pixels(wires: Wires, fraction: float, rng: Generator) -> NDArray[np.int64]:
    """(n, 2) x, y of at least one pixel."""
    count = max(round(fraction * wires.shape[0] * wires.shape[1]), 1)
    chosen = rng.choice(wires.shape[0] * wires.shape[1], count, replace=False)
    return np.column_stack([chosen % wires.shape[1], chosen // wires.shape[1]])


def _hot(events: Floats, p: Parameters, wires: Wires, rng: Generator) -> Floats:
    """Poisson events on top of the pixel's own, at rates exponential over the hot pixels."""
    fixed = wires.fixed or rng
    pixels = _some_pixels(wires, p["fraction"], fixed)
    rate = 5 + fixed.exponential(p["mean_hz"] - 5, len(pixels))
    wires.patterns["hot_pixels"], wires.patterns["hot_hz"] = pixels, rate
    own = np.repeat(np.arange(len(pixels)), rng.poisson(rate * wires.end_us * 1e-6))
    t = rng.uniform(0, wires.end_us, own.size)
    sign = np.where(rng.random(own.size) < p["on_share"], 1.0, -1.0)
    return np.concatenate([events, np.column_stack([t, pixels[own].astype(float), sign])])


def _dead(events: Floats, p: Parameters, wires: Wires, rng: Generator) -> Floats:
    pixels = wires.patterns["dead_pixels"] = _some_pixels(wires, p["fraction"], wires.fixed or rng)
    silent = np.zeros(wires.shape, bool)
    silent[pixels[:, 1], pixels[:, 0]] = True
    heard = ~silent[events[:, 2].astype(int), events[:, 1].astype(int)]
    return np.asarray(events[heard])


def _late(events: Floats, p: Parameters, wires: Wires, rng: Generator) -> Floats:
    late = events.copy()
    late[:, 0] += p["delay_us"] + p["jitter_us"] * rng.standard_normal(len(events))
    return late


def _quantised(events: Floats, p: Parameters, wires: Wires, rng: Generator) -> Floats:
    coarse = events.copy()
    coarse[:, 0] = p["quantum_us"] * np.floor(events[:, 0] / p["quantum_us"])
    return coarse


def _arbiter(events: Floats, p: Parameters, wires: Wires, rng: Generator) -> Floats:
    return np.asarray(_round_robin(events, p["us_per_event"], wires.shape[0], wires.shape[1]))


@njit(cache=True, nogil=True)
def _round_robin(events: Any, us_per_event: float, height: int, width: int) -> Any:
    """A token goes round the rows. The row it stops at is latched: what waits there gets the stamp of that
    moment and takes us_per_event each on the bus. A pixel that waits makes no further event."""
    waiting = np.zeros((height, width))
    queue = np.zeros(height, np.int64)
    out = np.empty_like(events)
    at, used, waits, row, now = 0, 0, 0, 0, 0.0
    while at < len(events) or waits > 0:
        if waits == 0:
            now = max(now, events[at, 0])
        while at < len(events) and events[at, 0] <= now:
            x, y = int(events[at, 1]), int(events[at, 2])
            if waiting[y, x] == 0:
                waiting[y, x] = events[at, 3]
                queue[y] += 1
                waits += 1
            at += 1
        while queue[row] == 0:
            row = (row + 1) % height
        for x in range(width):
            if waiting[row, x] != 0:
                out[used, 0], out[used, 1], out[used, 2], out[used, 3] = now, x, row, waiting[row, x]
                waiting[row, x] = 0
                used += 1
        now += queue[row] * us_per_event
        waits -= queue[row]
        queue[row] = 0
        row = (row + 1) % height
    return out[:used]


def _overflow(events: Floats, p: Parameters, wires: Wires, rng: Generator) -> Floats:
    """The bus drains at a rate such that about the asked part is lost."""
    low, high = 0.2 * len(events) / wires.end_us, 100 * len(events) / wires.end_us
    for _ in range(30):
        drain = float(np.sqrt(low * high))
        enough = _leaky_bucket(events[:, 0], p["buffer_events"], drain).mean() >= 1 - p["lost"]
        low, high = (low, drain) if enough else (drain, high)
    wires.patterns["usb_events_per_s"] = 1e6 * high
    return np.asarray(events[_leaky_bucket(events[:, 0], p["buffer_events"], high)])


@njit(cache=True, nogil=True)
def _leaky_bucket(t: Any, capacity: float, drain_per_us: float) -> Any:
    """Which events get through: a full buffer takes nothing in until it is half empty."""
    kept = np.ones(t.size, np.bool_)
    level, stalled = 0.0, False
    for n in range(t.size):
        level = max(level - drain_per_us * (t[n] - t[n - 1]), 0.0) if n else 0.0
        if level >= capacity - 1:
            stalled = True
        if level < capacity / 2:
            stalled = False
        kept[n] = not stalled
        level += not stalled
    return kept


def _after_events(events: Floats, p: Parameters, wires: Wires, rng: Generator) -> Floats:
    again = events[rng.random(len(events)) < p["chance"]].copy()
    again[:, 0] += rng.exponential(p["mean_us"], len(again))
    return np.concatenate([events, again])


def _shadowed(events: Floats, p: Parameters, wires: Wires, rng: Generator) -> Floats:
    """OFF events are lost for a while after an ON event in the row above or below."""
    return np.asarray(events[_lit(events, p["shadow_us"], wires.shape[0])])


@njit(cache=True, nogil=True)
def _lit(events: Any, shadow_us: float, height: int) -> Any:
    kept = np.ones(len(events), np.bool_)
    last = np.full(height + 2, -1e18)
    for n in range(len(events)):
        t, row = events[n, 0], int(events[n, 2]) + 1
        if events[n, 3] > 0:
            last[row] = t
        elif t < max(last[row - 1], last[row + 1]) + shadow_us:
            kept[n] = False
    return kept


READOUT: dict[str, Callable[[Floats, Parameters, Wires, Generator], Floats]] = {
    "after_events": _after_events,
    "row_shadow": _shadowed,
    "hot_pixels": _hot,
    "dead_pixels": _dead,
    "latency": _late,
    "readout": _arbiter,
    "usb_overflow": _overflow,
    "timestamp_quantum": _quantised,
}
