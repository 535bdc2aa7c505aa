"""Same-pixel intervals between events, each with what the light did meanwhile."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator.kernel import kernel

from ..light.scene import TRUSTED, Scene
from ..windows import Mask, Windows

INTERVAL = np.dtype([
    ("pixel", "<i4"),
    ("start_us", "<f8"),  # of the event that begins it
    ("end_us", "<f8"),  # of the event that ends it, or when it is no longer seen
    ("end", "i1"),  # +1 an ON event, -1 an OFF event, 0 none was seen
    ("start", "i1"),  # polarity of the event that begins it, +1 or -1
    ("before", "<f4"),  # light when the pixel comes free [DN]
    ("after", "<f4"),  # and at the end
    ("slope", "<f4"),  # its change at the end [DN/us]
    ("mean", "<f4"),
    ("lowest", "<f4"),
    ("highest", "<f4"),
    ("doubt", "<f4"),  # how far `before` and `after` may be off [DN]
])  # fmt: skip

Intervals = NDArray[np.void]


def intervals(
    events: NDArray[np.void],
    scene: Scene,
    keep: NDArray[np.bool_],
    masked: Mask | Windows,
    dead_us: float = 0.0,
    delay_us: float = 0.0,
    tolerance: float = TRUSTED,
) -> Intervals:
    """The intervals of the pixels in `keep` (H, W), of dtype INTERVAL, by pixel and then time.

    Each begins with an event: what a pixel does after one does not depend on what it did before, so intervals
    are fair whatever the recording's start was. An event in a masked time (a Mask, or windows (M, 2) [us] of
    all rows) ends an interval unseen where the mask begins, and begins none. So do times in which the light
    is not known (`Scene.trusted` to `tolerance`). The last one of each pixel ends unseen at the end of the
    scene. dead_us: what the light does in this time after an event is lost. delay_us: events are this much
    late.
    """
    event_pixel = events["y"].astype(np.int64) * scene.width + events["x"]
    chosen = keep.ravel()[event_pixel]
    order = np.argsort(event_pixel[chosen], kind="stable")
    pixel = event_pixel[chosen][order]
    t_us = events["t"][chosen][order].astype(np.float64)
    polarity = np.where(events["p"][chosen][order], 1, -1).astype(np.int8)
    mask = masked if isinstance(masked, Mask) else Mask(masked)
    window_start = mask.start(t_us, pixel // scene.width)
    inside = (t_us - delay_us >= scene.t_us[0]) & (t_us - delay_us + dead_us < scene.t_us[-1])
    pixel, t_us, polarity, window_start = (a[inside] for a in (pixel, t_us, polarity, window_start))
    found: Intervals = np.zeros(len(pixel), INTERVAL)
    used, row = np.unique(np.asarray(pixel, np.int64), return_inverse=True)
    planes = np.ascontiguousarray(scene.images.reshape(len(scene.images), -1)[:, used].T)
    trusted = np.ascontiguousarray(scene.trusted(tolerance)[:, used].T)
    walk(
        row, pixel, t_us - delay_us, polarity, window_start - delay_us, planes,
        scene.t_us.astype(np.float64), trusted, scene.taken_us.astype(np.float64), dead_us, found
    )  # fmt: skip
    found = found[found["start"] != 0]
    found["doubt"] = np.hypot(*(scene.doubt(found["pixel"], found[side]) for side in ("start_us", "end_us")))
    return found


@kernel
def walk(
    row: Any, pixel: Any, t_us: Any, polarity: Any, seen_until: Any, planes: Any, knots: Any, trusted: Any,
    taken: Any, dead: Any,
    found: Any,
) -> None:  # fmt: skip
    """Fill found[i] with the interval that event i begins; one that begins none keeps start = 0.

    row (n,): the event's pixel as a row of planes (pixels, knots) [DN]; seen_until (n,) [us]: t_us, or the
    start of the masked time the event lies in.
    """
    knot, last = 0, knots.shape[0] - 1
    for i in range(t_us.shape[0]):
        if i == 0 or pixel[i] != pixel[i - 1]:
            knot = 0
        if seen_until[i] < t_us[i]:  # began in a masked time
            continue
        goes_on = i + 1 < t_us.shape[0] and pixel[i + 1] == pixel[i]
        end = min(seen_until[i + 1], knots[last]) if goes_on else knots[last]
        known = known_until(trusted[row[i]], taken, t_us[i])
        begin = t_us[i] + dead
        if end < t_us[i] or known <= t_us[i]:
            continue
        seen = goes_on and seen_until[i + 1] == t_us[i + 1] and end <= known
        end = min(end, known)
        begin = min(begin, end)
        while knot < last - 1 and knots[knot + 1] <= begin:
            knot += 1
        light = planes[row[i]]
        k, at = knot, begin
        level = between(light, knots, k, begin)
        first, low, high, area = level, level, level, 0.0
        while k < last - 1 and knots[k + 1] < end:
            k += 1
            area += 0.5 * (level + light[k]) * (knots[k] - at)
            at, level = knots[k], light[k]
            low, high = min(low, level), max(high, level)
        final = between(light, knots, k, end)
        area += 0.5 * (level + final) * (end - at)
        one = found[i]
        one.pixel, one.start_us, one.end_us = pixel[i], t_us[i], end
        one.end = polarity[i + 1] if seen else 0
        one.start = polarity[i]
        one.before, one.after = first, final
        one.slope = (light[k + 1] - light[k]) / (knots[k + 1] - knots[k])
        one.mean = area / (end - begin) if end > begin else first
        one.lowest, one.highest = min(low, final), max(high, final)


@kernel
def between(light: Any, knots: Any, k: Any, t: Any) -> Any:
    """The light at time t in the segment that begins at knot k, on a straight line."""
    return light[k] + (light[k + 1] - light[k]) * (t - knots[k]) / (knots[k + 1] - knots[k])


@kernel
def known_until(trusted: Any, taken: Any, t: Any) -> Any:
    """Until when the light is trusted (gaps between frames,) from time t on; t itself where it is not."""
    gaps = trusted.shape[0]
    k = min(max(np.searchsorted(taken, t, side="right") - 1, 0), gaps - 1)
    if not trusted[k]:
        return t
    while k < gaps and trusted[k]:
        k += 1
    return taken[k]
