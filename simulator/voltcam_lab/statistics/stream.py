"""The events of a recording, each with where and when it was in the setting, found in one pass."""

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_lab.light.known import SETTLED_US
from voltcam_lab.statistics.halves import HALVES
from voltcam_lab.statistics.setting import Setting
from voltcam_lab.statistics.strata import INTENSITIES, REST, SLOPES
from voltcam_simulator.kernel import kernel
from voltcam_simulator.key_order import in_rising_order

_CLASSES = np.divmod(np.arange(INTENSITIES * SLOPES, dtype=np.int32), SLOPES)  # of each stratum's index
NONE = -1
"""Interval of an event that has no other of its pixel before it."""
_OF_PIXELS = ("ends", "between", "in_any_light")
"""Of EventTable: has a place for each pixel, not a row for each event."""


@dataclass(frozen=True, eq=False)
class EventTable:
    """n events in the order (t, pixel, polarity), of the setting's pixels and time only. Columns (n,),
    but the last three."""

    t_us: NDArray[np.int64]
    pixel: NDArray[np.int32]
    """y W + x."""
    place: NDArray[np.int32]
    """`Setting.place` of the pixel."""
    on: NDArray[np.int32]
    """1 for ON, 0 for OFF."""
    part: NDArray[np.uint8]
    quarter: NDArray[np.uint8]
    """Number of the time block, modulo 4."""
    intensity: NDArray[np.int32]
    slope: NDArray[np.int32]
    moving: NDArray[np.int32]
    """1 unless at rest."""
    log: NDArray[np.float32]
    """ln(L + k2) of the pixel then."""
    interval_us: NDArray[np.int64]
    """To the last event of the pixel; NONE, too, where its light has not been known all the time since.
    `former` is that event's number."""
    former: NDArray[np.int32]
    unsettled: NDArray[np.uint8]
    """1 where light that is not known may have made the event: it is less than SETTLED_US ago, and no other
    event came since. What was before the recording is not known either."""
    ends: NDArray[np.int32]
    """(HALVES, 2, K): numbers of a pixel's first and last event of each half; -1 where it has no two."""
    between: NDArray[np.int32]
    """(HALVES, 2 polarities, K): how many events of it, in any light, come after the first up to the last."""
    in_any_light: NDArray[np.int32]
    """(HALVES, K): how many events a pixel has."""

    @cached_property
    def settled(self) -> "EventTable":
        """Without those that are `unsettled`: for counts. `former` and `ends` mean nothing in it."""
        kept = np.flatnonzero(self.unsettled == 0)
        rows = {one.name: getattr(self, one.name)[kept] for one in fields(self) if one.name not in _OF_PIXELS}
        return replace(self, **rows)

    @cached_property
    def thirds(self) -> NDArray[np.int64]:
        """Numbers of the events that are a pixel's third of one polarity, all moving or all at rest."""
        kind = 2 * self.moving + self.on
        same = (self.former >= 0) & (kind[self.former] == kind)
        return np.flatnonzero(same & same[self.former])


def stream_of(setting: Setting, events: NDArray[np.void]) -> EventTable:
    """Put events (EVENT dtype, in any order) in order and find their place in the setting.

    Those in light that is not known are left out, but for `between` and `in_any_light`.
    """
    key, bits = ordered(setting, setting.known.where(events))
    n = len(key)
    t_us, interval_us, log = np.empty(n, np.int64), np.empty(n, np.int64), np.empty(n, np.float32)
    pixel, place, on, intensity, slope, moving, former = np.empty((7, n), np.int32)
    part, quarter, unsettled = np.empty((3, n), np.uint8)
    locate(
        key, bits, setting.place, setting.known.taken_us, setting.known.last_unknown, setting.scene.t_us,
        setting.log_light, setting.strata.index, setting.block_edges_us, setting.tiles.ravel(), *_CLASSES,
        REST, t_us, pixel, place, on, part, quarter, intensity, slope, moving, log, interval_us, former,
        unsettled,
    )  # fmt: skip
    return EventTable(
        t_us, pixel, place, on, part, quarter, intensity, slope, moving, log, interval_us, former, unsettled,
        *_of_pixels(setting, events, t_us, place),
    )  # fmt: skip


def _of_pixels(
    setting: Setting, events: NDArray[np.void], t_us: NDArray[np.int64], place: NDArray[np.int32]
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]:
    """`ends`, `between` and `in_any_light` of an EventTable with these columns, of these events."""
    shape = (HALVES, 2, len(setting.pixels))
    ends, between = np.full(shape, -1, np.int32), np.zeros(shape, np.int32)
    in_any_light = np.zeros((HALVES, len(setting.pixels)), np.int32)
    first_us, last_us = np.full((2, *in_any_light.shape), np.iinfo(np.int64).max)
    find_ends(t_us, place, setting.halves.middle_us, ends, first_us, last_us)
    t, x, y, p = (np.ascontiguousarray(events[name]) for name in "txyp")
    edges_us = setting.block_edges_us[0], setting.halves.middle_us, setting.block_edges_us[-1]
    count_events(
        t, x, y, p, setting.place, setting.scene.width, *edges_us, first_us, last_us, between, in_any_light
    )
    return ends, between, in_any_light


def ordered(setting: Setting, events: NDArray[np.void]) -> tuple[NDArray[np.int64], int]:
    """One number for each event, sorted, with time, pixel, polarity from high to low; the bits below time.

    The order of events of the same time must not matter, so they get one.
    """
    bits = int(setting.place.size - 1).bit_length() + 1
    t, x, y, p = (np.ascontiguousarray(events[name]) for name in "txyp")
    key = np.empty(len(events), np.int64)
    count = number(t, x, y, p, setting.block_edges_us, setting.place, setting.scene.width, bits, key)
    return in_rising_order(key[:count].view(np.uint64)).view(np.int64), bits


@kernel
def find_ends(t_us: Any, place: Any, middle_us: Any, ends: Any, first_us: Any, last_us: Any) -> None:
    """Fill ends with the numbers of the first and last event of each pixel in each half, and their times."""
    for i in range(t_us.size):
        half, k = 1 if t_us[i] > middle_us else 0, place[i]
        if ends[half, 0, k] < 0:
            ends[half, 0, k] = i
        else:
            ends[half, 1, k] = i
    for half in range(ends.shape[0]):
        for k in range(ends.shape[2]):
            if ends[half, 1, k] < 0:
                ends[half, 0, k] = -1
            else:
                first_us[half, k], last_us[half, k] = t_us[ends[half, 0, k]], t_us[ends[half, 1, k]]


@kernel
def count_events(
    t: Any, x: Any, y: Any, p: Any, places: Any, width: Any, begin_us: Any, middle_us: Any, end_us: Any,
    first_us: Any, last_us: Any, between: Any, in_any_light: Any,
) -> None:  # fmt: skip
    """Count the events of each pixel in each half, in any order, and of these those after its first one, up
    to its last; before and behind none counts."""
    for i in range(t.size):
        k = places[np.int64(y[i]) * width + x[i]]
        if k >= 0 and begin_us < t[i] <= end_us:
            half = 1 if t[i] > middle_us else 0
            in_any_light[half, k] += 1
            if first_us[half, k] < t[i] <= last_us[half, k]:
                between[half, np.int64(p[i]), k] += 1


@kernel
def number(t: Any, x: Any, y: Any, p: Any, edges_us: Any, place: Any, width: Any, bits: Any, key: Any) -> Any:
    """Fill the keys of the events within the edges, of pixels with a place; how many there are."""
    n = 0
    for i in range(t.size):
        if t[i] > edges_us[0] and t[i] <= edges_us[-1]:
            pixel = np.int64(y[i]) * width + x[i]
            if place[pixel] >= 0:
                key[n] = (t[i] - edges_us[0]) << bits | pixel << 1 | p[i]
                n += 1
    return n


@kernel
def locate(
    key: Any, bits: Any, places: Any, taken_us: Any, last_unknown: Any, scene_us: Any, log_light: Any,
    index: Any, edges_us: Any, tiles: Any, intensities: Any, slopes: Any, rest: Any,
    t_us: Any, pixel: Any, place: Any, on: Any, part: Any, quarter: Any, intensity: Any, slope: Any,
    moving: Any, log: Any, interval_us: Any, former: Any, unsettled: Any,
) -> None:  # fmt: skip
    """Fill the columns from t_us on. An event at t is of the step (from, to] that t lies in."""
    last, last_gap = np.full(places.size, -1, np.int32), np.zeros(places.size, np.int32)
    step, block, gap = 0, 0, 0
    for i in range(key.size):
        t, p = (key[i] >> bits) + edges_us[0], (key[i] & ((1 << bits) - 1)) >> 1
        while step + 2 < scene_us.size and t > scene_us[step + 1]:
            step += 1
        while block + 2 < edges_us.size and t > edges_us[block + 1]:
            block += 1
        while gap + 2 < taken_us.size and t >= taken_us[gap + 1]:
            gap += 1
        k = places[p]
        t_us[i], pixel[i], place[i], on[i] = t, p, k, key[i] & 1
        share = np.float32((t - scene_us[step]) / (scene_us[step + 1] - scene_us[step]))
        log[i] = log_light[step, k] + share * (log_light[step + 1, k] - log_light[step, k])
        part[i], quarter[i] = 2 * (block % 2) + tiles[p], block % 4
        intensity[i], slope[i] = intensities[index[step, k]], slopes[index[step, k]]
        moving[i] = slope[i] != rest
        former[i] = last[p] if last_unknown[gap, p] <= last_gap[p] else -1
        unsettled[i] = former[i] < 0 and t < taken_us[last_unknown[gap, p] + 1] + SETTLED_US
        interval_us[i] = t - t_us[former[i]] if former[i] >= 0 else -1
        last[p], last_gap[p] = i, gap
