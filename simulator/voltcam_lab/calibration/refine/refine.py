"""A camera's parameters refined by simulation: what the likelihood of single intervals cannot tell.

The light itself (how sharp, how a grey level stands for light), why events are late, noise out of the
blue: each changes what a simulation gives out, so it is tried, with the same random numbers each time
(Gourieroux, Monfort, Renault 1993; Hooke and Jeeves 1961; Nelder and Mead 1965). Steps are judged on one part
of the pixels; a mechanism, or other light, stays only if the other part, which saw no steps, comes closer.
Where the light stays as it is, only events in light that is known count: else parameters would make up for
the light between frames of this recording, and be wrong in any other.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters

from ...distances import FrameLight, Region, by_pixels
from ...light.scene import Scene
from .coordinate_search import CoordinateSearch
from .coordinates import (
    ABSENT,
    CORE,
    parameters_at,
    point_of,
)
from .goal import Goal

DEVELOPED_PIXELS = 12  # side of the tiles, every other one of which judges what is kept
KNOWN = 0.3  # of the brightness: light that is further off between frames takes no part
LONGEST = 40e6  # pixels times images of light that are simulated, unless told otherwise


@dataclass(frozen=True, eq=False)
class Refined:
    """parameters: of the camera. scene: the light they belong to; light: what was done to it. kept:
    mechanisms that are there; dropped: tried, of no use. before, after: scores of the pixels that took part
    in no step."""

    parameters: Parameters
    scene: Scene
    light: str
    kept: tuple[str, ...]
    dropped: tuple[str, ...]
    before: float
    after: float


def known_share(events: NDArray[np.void], scene: Scene) -> float:
    """Of the events, those in light that is known well enough to take part where it stays as it is."""
    return float(scene.known(KNOWN).within(events).mean())


def refine(
    events: NDArray[np.void],
    scene: Scene,
    light: FrameLight,
    fitting: Region,
    start: Parameters,
    seed: int = 0,
    report: Callable[[str], None] = lambda step: None,
    same_light: bool = False,
    longest: float = LONGEST,
) -> Refined:
    """Parameters near `start` whose events in `fitting` are closest to the recording's.

    events (EVENT): the recording's, in order of time; light: its frames. Effects that the search has no
    coordinate for stay as they are in `start`. same_light: the scene stays as it is, for a camera that will
    see others. longest: pixels times images of light that are simulated, the busiest stretch of more.
    """
    part = _busiest(events, scene, fitting, longest)
    known = scene.known(KNOWN) if same_light else None
    seen, other = (Goal(events, half, light, known) for half in by_pixels(part, DEVELOPED_PIXELS))
    search = CoordinateSearch(start, seen, other, scene, part, seed, report)
    point = point_of(start)
    before = search.unseen(point)
    point = search.first(point)
    lit = search.light(point, same_light)
    point, kept = search.offered(lit.point)
    point = search.polished(point, CORE + kept)
    point, kept = search.without_needless(point, kept)
    return Refined(
        parameters=parameters_at(point, start),
        scene=lit.scene,
        light=lit.words,
        kept=kept,
        dropped=tuple(name for name in ABSENT if name not in kept),
        before=before,
        after=search.unseen(point),
    )


def _busiest(events: NDArray[np.void], scene: Scene, region: Region, longest: float) -> Region:
    """The region in the stretch with most events that is short enough to be simulated often."""
    pixels = scene.width * scene.height
    images = max(int(longest / pixels), 2)
    if len(scene.t_us) <= images:
        return region
    t_us = np.sort(region.of(events)["t"])
    starts = np.arange(0, len(scene.t_us) - images + 1, max(images // 8, 1))
    edges = scene.t_us[starts], scene.t_us[starts + images - 1]
    counts = np.searchsorted(t_us, edges[1]) - np.searchsorted(t_us, edges[0])
    best = int(np.argmax(counts))
    return region.during(np.array([[edges[0][best], edges[1][best]]], np.int64))
