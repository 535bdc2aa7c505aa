"""The events of a recording, each with where and when it was in the setting, found in one pass."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_lab.statistics.setting import Setting
from voltcam_lab.statistics.strata import REST, SLOPES
from voltcam_simulator.kernel import kernel

NONE = -1
"""Interval of an event that has no other of its pixel before it."""


@dataclass(frozen=True, eq=False)
class EventTable:
    """n events in the order (t, pixel, polarity), of the setting's pixels and time only. Columns (n,)."""

    t_us: NDArray[np.int64]
    pixel: NDArray[np.int64]
    """y W + x."""
    on: NDArray[np.int64]
    """1 for ON, 0 for OFF."""
    part: NDArray[np.uint8]
    quarter: NDArray[np.uint8]
    """Number of the time block, modulo 4."""
    intensity: NDArray[np.int64]
    slope: NDArray[np.int64]
    moving: NDArray[np.int64]
    """1 unless at rest."""
    log: NDArray[np.float32]
    """ln(L + k2) of the pixel then."""
    interval_us: NDArray[np.int64]
    """To the last event of the pixel, or NONE; `former` is that event's number."""
    former: NDArray[np.int64]


def stream_of(setting: Setting, events: NDArray[np.void]) -> EventTable:
    """Put events (EVENT dtype, in any order) in order and find their place in the setting."""
    key, bits = ordered(setting, events)
    t_us = (key >> bits) + setting.block_edges_us[0]
    pixel, on = (key & ((1 << bits) - 1)) >> 1, key & 1
    n = len(key)
    part, quarter, stratum = np.empty((3, n), np.uint8)
    log, interval_us, former = np.empty(n, np.float32), np.empty(n, np.int64), np.empty(n, np.int64)
    locate(
        t_us, pixel, setting.place, setting.scene.t_us, setting.log_light, setting.strata.index,
        setting.block_edges_us, setting.tiles.ravel(), part, quarter, stratum, log, interval_us, former,
    )  # fmt: skip
    intensity, slope = np.divmod(stratum.astype(np.int64), SLOPES)
    moving = (slope != REST).astype(np.int64)
    return EventTable(t_us, pixel, on, part, quarter, intensity, slope, moving, log, interval_us, former)


def ordered(setting: Setting, events: NDArray[np.void]) -> tuple[NDArray[np.int64], int]:
    """One number for each event, sorted, with time, pixel, polarity from high to low; the bits below time.

    The order of events of the same time must not matter, so they get one.
    """
    begin_us, end_us = setting.block_edges_us[[0, -1]]
    pixel = events["y"].astype(np.int64) * setting.scene.width + events["x"]
    here = (events["t"] > begin_us) & (events["t"] <= end_us)
    here &= setting.place[np.where(here, pixel, 0)] >= 0
    bits = int(setting.place.size - 1).bit_length() + 1
    key = (events["t"] - begin_us) << bits | pixel << 1 | events["p"]
    return np.sort(key[here]), bits


@kernel
def locate(
    t_us: Any, pixel: Any, place: Any, scene_us: Any, log_light: Any, index: Any, edges_us: Any, tiles: Any,
    part: Any, quarter: Any, stratum: Any, log: Any, interval_us: Any, former: Any,
) -> None:  # fmt: skip
    """Fill the columns from part on. An event at t is of the step (from, to] that t lies in."""
    last = np.full(place.size, -1, np.int64)
    step, block = 0, 0
    for i in range(t_us.size):
        t, p = t_us[i], pixel[i]
        while step + 2 < scene_us.size and t > scene_us[step + 1]:
            step += 1
        while block + 2 < edges_us.size and t > edges_us[block + 1]:
            block += 1
        k = place[p]
        share = np.float32((t - scene_us[step]) / (scene_us[step + 1] - scene_us[step]))
        log[i] = log_light[k, step] + share * (log_light[k, step + 1] - log_light[k, step])
        part[i], quarter[i], stratum[i] = 2 * (block % 2) + tiles[p], block % 4, index[k, step]
        former[i] = last[p]
        interval_us[i] = t - t_us[last[p]] if last[p] >= 0 else -1
        last[p] = i
