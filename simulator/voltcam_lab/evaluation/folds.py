"""Which parts of a recording are fitted and which judged: never the same pixel, nor the same time."""

from collections.abc import Sequence

import numpy as np

from voltcam_simulator.effect import Events

from ..distances import Region, by_pixels, by_time
from ..distances.region import HELD_OUT_US, TILE_PIXELS, Halves

ENOUGH = 100_000
"""Events that are judged, from which one quarter of a recording says what all four would."""


def folds(region: Region, events: Events) -> list[Halves]:
    """(what to fit on, what to judge by): halves of the pixels times halves of the time make quarters, and
    what is fitted on one is judged by the one it shares nothing with. One way round; all four where events
    are few."""
    tiles = by_pixels(region, TILE_PIXELS)
    quarters = [by_time(tile, HELD_OUT_US) for tile in tiles]
    ways = [(quarters[i][j], quarters[1 - i][1 - j]) for i in (0, 1) for j in (0, 1)]
    _, judging = ways[0]
    return ways[:1] if judging.of(events).size >= ENOUGH else ways


def pooled_region(region: Region, ways: Sequence[Halves]) -> Region:
    """All that is judged. No interval goes from one quarter to another."""
    if len(ways) == 1:
        return ways[0][1]
    times = np.concatenate([ways[0][1].times, ways[1][1].times])
    return region.during(times[np.argsort(times[:, 0])])


def pooled(parts: Sequence[Events], ways: Sequence[Halves]) -> Events:
    """The events of each way's model where that is judged, sorted by time."""
    if len(ways) == 1:
        return parts[0]
    events = np.concatenate([judging.of(part) for part, (_, judging) in zip(parts, ways, strict=True)])
    in_order: Events = events[np.argsort(events["t"], kind="stable")]
    return in_order
