"""A camera's parameters refined by simulation: what the likelihood of single intervals cannot tell.

The light itself (how sharp, how a grey level stands for light), why events are late, noise out of the
blue: each changes what a simulation gives out, so it is tried, with the same random numbers each time
(Gourieroux, Monfort, Renault 1993; Hooke and Jeeves 1961; Branch, Coleman, Li 1999). Steps are judged on
one part of the pixels. A mechanism, or other light, stays only if the other part comes closer, with random
numbers of its own, by more than these make it differ.
Where the light stays as it is, steps are judged by events in light that is known. Else parameters would make
up for the light between frames of this recording, and be wrong in any other. Of a mechanism that known light
cannot tell, all events decide. There a grey level is light, as a sensor gives it out. Three more steps come
behind that. What black and white stand for is found by itself. The spread of thresholds and the frames' noise
are traded against the gain. All else is found once more.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters

from ...distances import FrameLight, Region, by_pixels
from ...distances.goal import Goal
from ...light.known import KnownLight
from ...light.scene import Scene
from .coordinate_search import CoordinateSearch
from .coordinates import ABSENT, CORE, parameters_at, point_of, present
from .judge import Judge, closer
from .light_search import closest_light, light_as_it_is

DEVELOPED_PIXELS = 12  # side of the tiles, every other one of which judges what is kept
KNOWN = 0.3  # of the brightness: light that is further off between frames takes no part
LEAST_END = 1e-3  # of the gaps between frames: fewer tell nothing of what black or white stands for
PEDESTALS_DN = (3.0, 6.0, 12.0, 24.0)
HIGHLIGHTS = (1.2, 1.5, 2.0, 4.0)
NARROWER = (0.6, 0.3, 0.0)
ROUNDING_DN = 0.3
SLACKS = (0.5, 1.0, 2.0, 3.0)  # standard deviations of the noise: what is further off is light
LONGEST = 40e6  # pixels times images of light that are simulated, unless told otherwise


@dataclass(frozen=True, eq=False)
class Refined:
    """parameters: of the camera. scene: the light they belong to; light: what was done to it. kept:
    mechanisms that are there; dropped: tried, of no use. before, after: mean scores of the pixels that took
    part in no step, in light that counts; closer: whether they differ by more than chance."""

    parameters: Parameters
    scene: Scene
    light: str
    kept: tuple[str, ...]
    dropped: tuple[str, ...]
    before: float
    after: float
    closer: bool


def known_share(events: NDArray[np.void], scene: Scene) -> float:
    """Of the events, those in light that is known well enough to take part where it stays as it is."""
    return float(scene.known(KNOWN).within(events).mean())


@dataclass(frozen=True, eq=False)
class Refinement:
    """Cameras are brought closer to a recording, by simulations of its light.

    events (EVENT): the recording's, in order of time; light: its frames; fitting: what of it counts. seed: of
    all simulations; report: is told of each step. Effects that the search has no coordinate for stay as they
    are. longest: pixels times images of light that are simulated, the busiest stretch of more.
    """

    events: NDArray[np.void]
    scene: Scene
    light: FrameLight
    fitting: Region
    seed: int = 0
    report: Callable[[str], None] = lambda step: None
    longest: float = LONGEST

    def refined(self, start: Parameters, same_light: bool = False) -> Refined:
        """Parameters near `start` whose events are closest to the recording's. same_light: the scene stays as
        it is, for a camera that will see others."""
        known = self._as_late(start).known(KNOWN) if same_light else None
        search = self._search(start, known)
        point = point_of(start)
        before = search.unseen(point)
        point = search.first(point)
        lit = (light_as_it_is if same_light else closest_light)(search, point)
        point = search.offered(lit.point)
        point = search.polished(point, CORE + present(point))
        point = search.without_needless(point)
        after = search.unseen(point)
        kept = present(point)
        return Refined(
            parameters=parameters_at(point, start),
            scene=lit.scene,
            light=lit.words,
            kept=kept,
            dropped=tuple(name for name in ABSENT if name not in kept),
            before=float(before[0].mean()),
            after=float(after[0].mean()),
            closer=closer(after, before),
        )

    def with_ends(self, start: Parameters) -> Parameters:
        """`start` with what black stands for, and white, by the events of pixels while frames have them so.

        All else that pixels do is as it was, so nothing makes up for it.
        """
        white = {"input_response": {"white_level_dn": self.scene.white_dn}}
        point, camera, late = point_of(start), start.changed(white), self._as_late(start)
        for name, sizes, known in (
            ("pedestal_dn", PEDESTALS_DN, late.black()),
            ("highlight", HIGHLIGHTS, late.white()),
        ):
            if known.gaps.mean() >= LEAST_END:
                self.report(f"refine: {name}")
                point = self._search(camera, known).end(point, name, sizes)
        if point == point_of(start):
            return start
        return parameters_at(point, camera if point["highlight"] > 1 else start)

    def with_spread_and_slack(self, start: Parameters, noise_dn: float) -> Parameters:
        """`start` with thresholds that spread less, and a slack for the frames' noise; each if it helps.

        Both take events from light that moves, and the gain is raised until there are as many as before: so
        it does not make up for light that is not known. An error of the light that stays with a pixel looks
        like a threshold of its own. noise_dn: standard deviation of a frame's grey level; rounding alone
        needs no slack, as light between frames is made without it.
        """
        search = self._search(start, known=None)
        first = point = point_of(start)
        sizes = {"threshold_spread": [first["threshold_spread"] * share for share in NARROWER]}
        if noise_dn > ROUNDING_DN:
            sizes["slack_dn"] = [noise_dn * size for size in SLACKS]
        for name in sizes:
            self.report(f"refine: {name}")
            point = search.traded(point, name, sizes[name])
        return start if point == first else parameters_at(point, start)

    def settled(self, start: Parameters) -> Parameters:
        """`start` where all is found, polished once more on light that is known."""
        point = self._search(start, self._as_late(start).known(KNOWN)).settled(point_of(start))
        return start if point == point_of(start) else parameters_at(point, start)

    def _as_late(self, parameters: Parameters) -> Scene:
        """The scene as late as events are: light that made an event is that of when it was due."""
        return self.scene.later(parameters.latency.delay_us)

    def _search(self, start: Parameters, known: KnownLight | None) -> CoordinateSearch:
        part = self._busiest()
        halves = by_pixels(part, DEVELOPED_PIXELS)
        seen, other = (Goal(self.events, half, self.light, known) for half in halves)
        judges = (other,) if known is None else (other, Goal(self.events, halves[1], self.light))
        judge = Judge(judges, self.seed)
        return CoordinateSearch(start, seen, judge, self.scene, part, self.seed, self.report)

    def _busiest(self) -> Region:
        """The region in the stretch with most events that is short enough to be simulated often."""
        scene, region = self.scene, self.fitting
        images = max(int(self.longest / (scene.width * scene.height)), 2)
        if len(scene.t_us) <= images:
            return region
        t_us = np.sort(region.of(self.events)["t"])
        starts = np.arange(0, len(scene.t_us) - images + 1, max(images // 8, 1))
        edges = scene.t_us[starts], scene.t_us[starts + images - 1]
        counts = np.searchsorted(t_us, edges[1]) - np.searchsorted(t_us, edges[0])
        best = int(np.argmax(counts))
        return region.during(np.array([[edges[0][best], edges[1][best]]], np.int64))
