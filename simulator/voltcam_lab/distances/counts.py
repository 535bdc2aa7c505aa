"""Distances and figures from numbers of events: where and when, at rest, and how much pixels differ."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator.effect import Events

from ..light.frame_light import FrameLight
from .region import Region

BIN_US = 50_000
BLOCK_PIXELS = 4
BRIGHTNESS_EDGES_DN = np.arange(0, 257, 32)

Array = NDArray[np.float64]
Counts = NDArray[np.int64]


def count_images(events: Events, region: Region) -> Counts:
    """(bins, rows, columns): events of each 4 x 4 pixels in each 50 ms, which count from the first time."""
    events = region.of(events)
    rows, columns = _blocks(region.pixels.shape)
    begin, bins = _bins(region)
    number = (events["t"] - begin) // BIN_US
    block = events["y"].astype(np.int64) // BLOCK_PIXELS * columns + events["x"] // BLOCK_PIXELS
    counts = np.bincount(number * (rows * columns) + block, minlength=bins * rows * columns)
    return counts.reshape(bins, rows, columns)


def watched(region: Region) -> NDArray[np.bool_]:
    """Cells of `count_images` of which at least half the time and half the pixels is in the region."""
    rows, columns = _blocks(region.pixels.shape)
    begin, bins = _bins(region)
    y, x = np.nonzero(region.pixels)
    pixels = np.bincount(y // BLOCK_PIXELS * columns + x // BLOCK_PIXELS, minlength=rows * columns)
    enough = (2 * pixels >= BLOCK_PIXELS**2).reshape(rows, columns)
    live = region.live_in(begin + BIN_US * np.arange(bins + 1, dtype=np.int64))
    cells: NDArray[np.bool_] = (2 * live >= BIN_US)[:, None, None] & enough
    return cells


def correlation(a: Counts, b: Counts, cells: NDArray[np.bool_]) -> float:
    """Pearson's correlation of two count images over some cells; NaN where one of them is constant."""
    first, last = a[cells], b[cells]
    if first.size < 2 or np.ptp(first) == 0 or np.ptp(last) == 0:
        return float("nan")
    return float(np.corrcoef(first, last)[0, 1])


def _blocks(shape: tuple[int, ...]) -> tuple[int, int]:
    return -(-shape[0] // BLOCK_PIXELS), -(-shape[1] // BLOCK_PIXELS)


def _bins(region: Region) -> tuple[int, int]:
    """First time and number of the bins."""
    if not len(region.times):
        return 0, 0
    begin, end = int(region.times[0, 0]), int(region.times[-1, 1])
    return begin, -(-(end - begin) // BIN_US)


def rates(events: Events, region: Region) -> tuple[float, float]:
    """ON and OFF events a second and pixel."""
    on = np.count_nonzero(region.of(events)["p"])
    return on / region.pixel_seconds, (region.of(events).size - on) / region.pixel_seconds


def dispersion(events: Events, region: Region) -> float:
    """Coefficient of variation, beyond a Poisson process's own, of the events of neighbouring pixels.

    From the variance within 4 x 4 blocks, so that the scene itself hardly counts. Negative: pixels are more
    alike than those of a Poisson process (the root of the amount that is missing). NaN with too few events.
    """
    events = region.of(events)
    height, width = region.pixels.shape
    pixel = events["y"].astype(np.int64) * width + events["x"]
    counts = np.bincount(pixel, minlength=height * width).reshape(height, width)
    blocks, inside = _whole_blocks(counts), _whole_blocks(region.pixels)
    blocks = blocks[inside.all(axis=1)].astype(np.float64)
    mean, variance = blocks.mean(axis=1), blocks.var(axis=1, ddof=1)
    # A block's squared mean is itself too large by the variance of the mean.
    square = float(np.sum(mean**2 - variance / BLOCK_PIXELS**2))
    if square <= 0:
        return float("nan")
    excess = float(np.sum(variance - mean)) / square
    return float(np.sign(excess) * np.sqrt(abs(excess)))


def _whole_blocks(plane: NDArray[np.generic]) -> NDArray[np.generic]:
    """(H, W) as (blocks, 16), less the rows and columns that fill none."""
    size = BLOCK_PIXELS
    rows, columns = plane.shape[0] // size, plane.shape[1] // size
    cut = plane[: rows * size, : columns * size].reshape(rows, size, columns, size)
    return cut.transpose(0, 2, 1, 3).reshape(rows * columns, size * size)


@dataclass(frozen=True, eq=False)
class NoiseRates:
    """Events at pixels in still light, by brightness: edges_dn (K + 1,), the others (K,). Rates in events a
    second and pixel, NaN where there was no such light."""

    edges_dn: Array
    on: Array
    off: Array
    pixel_seconds: Array


def noise_rates(
    events: Events, region: Region, light: FrameLight, edges_dn: NDArray[np.int64] = BRIGHTNESS_EDGES_DN
) -> NoiseRates:
    """Rates in still light by brightness."""
    events = in_still_light(events, region, light)
    bins = len(edges_dn) - 1
    brightness = light.brightness(events["t"], events["x"], events["y"])
    number = np.clip(np.searchsorted(edges_dn, brightness, side="right") - 1, 0, bins - 1)
    live_s = region.live_in(light.t_us) / 1e6
    seconds = np.zeros(bins)
    for i in np.flatnonzero(live_s):
        mean = (light.images[i].astype(np.float64) + light.images[i + 1]) / 2
        seconds += live_s[i] * np.histogram(mean[light.still[i] & region.pixels], edges_dn)[0]
    with np.errstate(invalid="ignore", divide="ignore"):
        on = np.bincount(number[events["p"]], minlength=bins) / seconds
        off = np.bincount(number[~events["p"]], minlength=bins) / seconds
    seen = seconds > 0
    return NoiseRates(
        edges_dn.astype(np.float64), np.where(seen, on, np.nan), np.where(seen, off, np.nan), seconds
    )


def in_still_light(events: Events, region: Region, light: FrameLight) -> Events:
    """The events at pixels whose light stands still."""
    events = region.of(events)
    events = events[(events["t"] >= light.t_us[0]) & (events["t"] < light.t_us[-1])]
    still: Events = events[light.still[light.interval_of(events["t"]), events["y"], events["x"]]]
    return still


def still_seconds(region: Region, light: FrameLight) -> Array:
    """(N - 1,): between each two frames, pixels of the region in still light times live seconds."""
    pixels = np.count_nonzero(light.still & region.pixels, axis=(1, 2))
    seconds: Array = pixels * region.live_in(light.t_us) / 1e6
    return seconds


def quiet_on_rate(events: Events, region: Region, light: FrameLight) -> float:
    """ON events a second and pixel where light stands still; NaN where it never does."""
    seconds = float(still_seconds(region, light).sum())
    return np.count_nonzero(in_still_light(events, region, light)["p"]) / seconds if seconds else float("nan")


def noise_difference(a: NoiseRates, b: NoiseRates) -> float:
    """Mean over pixels and time at rest of the difference in ON plus that in OFF [events/s/pixel], by
    brightness."""
    seen = a.pixel_seconds > 0
    if not seen.any():
        return float("nan")
    difference = np.abs(a.on - b.on)[seen] + np.abs(a.off - b.off)[seen]
    return float(np.average(difference, weights=a.pixel_seconds[seen]))
