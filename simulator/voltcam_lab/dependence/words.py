"""What a step of `told_apart` found, as a sentence: where real events are too many or too few."""

import numpy as np
from numpy.typing import NDArray

from .covariates import (
    LATTICE,
    LINES,
    ORDERS,
    PASTS,
    PATCHES_ACROSS,
    PHASES,
    TIMES,
    Covariate,
    past_edges_us,
)
from .told_apart import Telling

BODY = 0.5  # of the peak: what belongs to it
KINDS = {
    "own past": "the pixel's own past",
    "neighbours": "what its neighbours did",
    "row": "its row",
    "column": "its column",
    "bus": "the bus that all pixels share",
    "clock": "a clock locked to the frames",
    "slow time": "slow time",
    "pixel": "which pixel it is",
    "light": "light and its change",
}
_AGO = {
    "own_same": "after the pixel's last event of the same polarity",
    "own_other": "after the pixel's last event of the other polarity",
    "near_same": "after a neighbour's event of the same polarity",
    "near_other": "after a neighbour's event of the other polarity",
    "row": "after an event of the same row",
    "column": "after an event of the same column",
    "anybody": "after the last event of all",
}


def peak(step: Telling) -> tuple[int, int, int, float]:
    """(polarity, first bin, last bin, log ratio there) of what of a function tells most: real events too many
    or, below 0, too few."""
    weight = step.share * step.function**2
    polarity, at = (int(k) for k in np.unravel_index(int(weight.argmax()), weight.shape))
    function, share = step.function[polarity], step.share[polarity]
    same = (np.sign(function) == np.sign(function[at])) & (np.abs(function) >= BODY * abs(function[at]))
    first = last = at
    while first > 0 and same[first - 1]:
        first -= 1
    while last + 1 < same.size and same[last + 1]:
        last += 1
    body = slice(first, last + 1)
    return polarity, first, last, float(np.average(function[body], weights=share[body] + 1e-12))


def sentence(step: Telling) -> str:
    """For people: on what firing depends that the model's does not, and where most."""
    polarity, first, last, ratio = peak(step)
    kind = "a clock" if step.covariate.name == "clock" else KINDS[step.covariate.kind]
    nats = f"{1000 * step.gain:.1f} millinats an event"
    many = f"{_short(np.exp(ratio))} times as many" if ratio > 0 else f"{np.exp(ratio):.0%} of the"
    return (
        f"Firing depends on {kind} as the model's does not ({nats}). There "
        f"are {many} {'ON' if polarity else 'OFF'} events as simulated "
        f"{_where(step.covariate, first, last)}."
    )


def _where(covariate: Covariate, first: int, last: int) -> str:
    name = covariate.name
    if name in PASTS:
        if last == 0:
            return _AGO[name].replace("after", "at the very time of", 1)
        edges_us = past_edges_us()
        never = ", or before there was one" if last == len(edges_us) else ""
        return f"{_span(edges_us, first, last)} {_AGO[name]}{never}"
    if name == "order":
        if first == 0:
            return "that do not share row and time with the event before"
        steps = (f"{step} pixels" for step in (ORDERS[first - 1], ORDERS[last] - 1))
        low, high = ("the row's end" if len(step) > len("1000 pixels") else step for step in steps)
        return f"at the time of the event before and from {low} to {high} along its row"
    if name == "patch":
        return f"in the part {_place(first, PATCHES_ACROSS)} of the sensor, of 8 across and 6 down"
    if name == "lattice":
        return f"of the pixel {_place(first, LATTICE)} of each square of 4 x 4 pixels"
    if name == "clock":
        return f"at {first / PHASES:.0%} to {(last + 1) / PHASES:.0%} of the {covariate.title}"
    sizes = {"frame": PHASES, "time": TIMES, "y": LINES, "x": LINES}
    size = sizes[name]
    part = f"{first / size:.0%} to {(last + 1) / size:.0%} of the"
    return {
        "frame": f"at {part} way from frame to frame",
        "time": f"in {part} recording",
        "y": f"at {part} height",
        "x": f"at {part} width",
    }[name]


def _place(number: int, across: int) -> str:
    """Column and row, counted from 0."""
    return f"({number % across}, {number // across})"


def _span(edges_us: NDArray[np.float64], first: int, last: int) -> str:
    low = "0 us" if first == 0 else _time(edges_us[first - 1])
    return f"later than {low}" if last == len(edges_us) else f"{low} to {_time(edges_us[last])}"


def _time(us: float) -> str:
    for unit, size in (("s", 1e6), ("ms", 1e3)):
        if us >= size:
            return f"{_short(us / size)} {unit}"
    return f"{_short(us)} us"


def _short(number: float) -> str:
    """To two digits, without an exponent."""
    return f"{float(f'{number:.2g}'):g}"
