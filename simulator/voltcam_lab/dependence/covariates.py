"""What the firing of a pixel may depend on, of each event as the number of a bin."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator.effect import Events

from ..light.frame_light import FrameLight
from .clock import RowClock
from .past import past_of

Bins = NDArray[np.int64]
Kind = Literal["own past", "neighbours", "row", "column", "bus", "clock", "slow time", "pixel", "light"]

DECADES_PER_BIN = 0.15
PAST_DECADES = 7
PAST_BINS = round(PAST_DECADES / DECADES_PER_BIN) + 2  # one for the same time, one for longer or never
PHASES, TIMES, LINES = 40, 12, 24
BRIGHTNESSES, CHANGES = 8, 11
ORDERS = np.array([-1 << 30, -16, -4, -1, 1, 2, 3, 5, 9, 17, 33, 65, 129, 1 << 30])  # pixels along the row


@dataclass(frozen=True)
class Covariate:
    """What it is, in words and by kind; how many bins for each polarity."""

    name: str
    kind: Kind
    title: str
    size: int


PASTS: Mapping[str, tuple[Kind, str]] = {
    "own_same": ("own past", "time since the pixel's own event of the same polarity"),
    "own_other": ("own past", "time since the pixel's own event of the other polarity"),
    "near_same": ("neighbours", "time since a neighbour's event of the same polarity"),
    "near_other": ("neighbours", "time since a neighbour's event of the other polarity"),
    "row": ("row", "time since an event of the same row"),
    "column": ("column", "time since an event of the same column"),
    "anybody": ("bus", "time since any event"),
}
COVARIATES = (
    *(Covariate(name, kind, title, PAST_BINS) for name, (kind, title) in PASTS.items()),
    Covariate(
        "order", "bus", "step along the row from the event before, where both have one time", len(ORDERS)
    ),
    Covariate("frame", "clock", "time since the last frame's stamp", PHASES),
    Covariate("time", "slow time", "time in the recording", TIMES),
    Covariate("y", "row", "which row it is", LINES),
    Covariate("x", "column", "which column it is", LINES),
)
PATCHES_ACROSS, PATCHES_DOWN, LATTICE = 8, 6, 4
FINER = (
    Covariate("patch", "pixel", "which part of the sensor it is, row by row", PATCHES_ACROSS * PATCHES_DOWN),
    Covariate("lattice", "pixel", "place in a lattice of 4 x 4 pixels, row by row", LATTICE**2),
)
"""Beside the others where it is asked which pixel it is."""
LIGHT = Covariate("light", "light", "brightness and its change", BRIGHTNESSES * CHANGES)


def past_edges_us() -> NDArray[np.float64]:
    """(PAST_BINS - 1,): where the bins of a past end; the first holds what has the same time."""
    return np.concatenate([[1.0], 10 ** (DECADES_PER_BIN * np.arange(1, PAST_BINS - 1))])


@dataclass(frozen=True, eq=False)
class Look:
    """What is the same for the streams that are compared: the sensor, its frames, classes of the light.

    covariates: what is looked at beside the light. clock: one that was found, for that of its name.
    """

    width: int
    height: int
    light: FrameLight
    brightness_dn: NDArray[np.float64]
    change_per_s: NDArray[np.float64]
    covariates: tuple[Covariate, ...] = COVARIATES
    clock: RowClock | None = None

    def finer(self, clock: RowClock | None) -> "Look":
        """With which pixel it is, and with the phase of a clock that a scan has found."""
        covariates = (*COVARIATES, *FINER)
        if clock is not None:
            covariates = (*covariates, Covariate("clock", "clock", f"phase of {clock}", PHASES))
        return replace(self, covariates=covariates, clock=clock)

    @classmethod
    def at(cls, real: Events, width: int, height: int, light: FrameLight) -> "Look":
        """With classes that hold alike many of the real events."""
        where = real["t"], real["x"], real["y"]
        level, change = light.brightness(*where), light.change(*where)
        return cls(width, height, light, _quantiles(level, BRIGHTNESSES), _quantiles(change, CHANGES))

    def bins(self, events: Events) -> dict[str, Bins]:
        """For each covariate and the light the bin of every event, polarities apart: (n,) each."""
        past = past_of(events, self.width, self.height)
        on = events["p"].astype(np.int64)
        found = {name: _past_bins(getattr(past, name)) for name in PASTS}
        found["order"] = _order(events)
        found |= self._places(events) | {"light": self._light(events)}
        if self.clock is not None:
            found["clock"] = _cut(self.clock.turn(events), PHASES)
        sizes = {each.name: each.size for each in (*COVARIATES, *FINER, *self.covariates, LIGHT)}
        return {name: on * sizes[name] + bins for name, bins in found.items()}

    def _places(self, events: Events) -> dict[str, Bins]:
        t_us, begin, end = events["t"], *self.light.t_us[[0, -1]]
        number = self.light.interval_of(t_us)
        start, stop = self.light.t_us[number], self.light.t_us[number + 1]
        across = _cut(events["x"] / self.width, PATCHES_ACROSS)
        x, y = (events[axis].astype(np.int64) % LATTICE for axis in "xy")
        return {
            "patch": _cut(events["y"] / self.height, PATCHES_DOWN) * PATCHES_ACROSS + across,
            "lattice": y * LATTICE + x,
            "frame": _cut((t_us - start) / (stop - start), PHASES),
            "time": _cut((t_us - begin) / max(end - begin, 1), TIMES),
            "y": _cut(events["y"] / self.height, LINES),
            "x": _cut(events["x"] / self.width, LINES),
        }

    def _light(self, events: Events) -> Bins:
        where = events["t"], events["x"], events["y"]
        level = np.searchsorted(self.brightness_dn, self.light.brightness(*where))
        return level * CHANGES + np.searchsorted(self.change_per_s, self.light.change(*where))


def _quantiles(values: NDArray[np.float64], classes: int) -> NDArray[np.float64]:
    shares = np.arange(1, classes) / classes
    return np.quantile(values, shares) if values.size else np.zeros(classes - 1)


def _cut(share: NDArray[np.float64], bins: int) -> Bins:
    return np.clip((share * bins).astype(np.int64), 0, bins - 1)


def _past_bins(span_us: NDArray[np.int64]) -> Bins:
    decades = np.log10(np.maximum(span_us, 1).astype(np.float64))
    return np.where(
        span_us == 0, 0, np.minimum(1 + (decades / DECADES_PER_BIN).astype(np.int64), PAST_BINS - 1)
    )


def _order(events: Events) -> Bins:
    """0: not of the row and the time of the event before."""
    x = events["x"].astype(np.int64)
    step = np.diff(x, prepend=0)
    together = np.zeros(len(events), bool)
    together[1:] = (events["t"][1:] == events["t"][:-1]) & (events["y"][1:] == events["y"][:-1])
    return np.where(together, np.searchsorted(ORDERS, step, side="right"), 0)
