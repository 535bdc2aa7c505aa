"""The light of a search: how sharp it is between frames, and how grey levels stand for it."""

from dataclasses import dataclass

from ...light.between_frames import calmed, evened, sharpened
from ...light.scene import Scene
from .coordinate_search import CoordinateSearch
from .coordinates import BENT, with_curvature
from .judge import Scores, closer
from .replay import Replay

SHARPENING = (0.15, 0.3, 0.45)
BENDS = ((1.0, 1.0), (0.6, 2.5), (0.6, 5.0))  # factors of gamma, and of the knee


@dataclass(frozen=True, eq=False)
class LightTrial:
    """A point in a light, and its score."""

    point: dict[str, float]
    score: float
    scene: Scene
    words: str
    sharpening: float


def light_as_it_is(search: CoordinateSearch, point: dict[str, float]) -> LightTrial:
    """The point in the search's light."""
    return LightTrial(point, search.score(point), search.scene, "as it was", 0.0)


def closest_light(search: CoordinateSearch, point: dict[str, float]) -> LightTrial:
    """The point with the light that is closest, which the search has from then on.

    How sharp light is and how grey levels stand for it make up for one another: both at once.
    """
    scene = search.scene
    found = best = light_as_it_is(search, point)
    even = evened(scene)
    lights = [(scene, "as it was", 0.0)]
    lights += [(sharpened(even, x), f"evened, sharpened by {x:g}", x) for x in SHARPENING]
    for bend, knee in BENDS:
        tried = with_curvature(point, bend * point["gamma"], knee * point["knee_dn"])
        for trial_scene, words, sharpening in lights:
            trial = _tried(search, tried, trial_scene, words, sharpening)
            best, tried = (trial if trial.score < best.score else best), trial.point
    found = _closer(search, best, found)
    calm = calmed(scene)
    if found.scene is not scene:
        calm = sharpened(evened(calm), found.sharpening)
    trial = _tried(search, found.point, calm, f"calmed, {found.words}", found.sharpening)
    found = _closer(search, trial, found)
    search.replay = Replay.of(found.scene, search.region)
    return found


def _tried(
    search: CoordinateSearch, point: dict[str, float], scene: Scene, words: str, sharpening: float
) -> LightTrial:
    search.report(f"refine: light {words}, gamma {point['gamma']:g}")
    search.replay = Replay.of(scene, search.region)
    point, score = search.moved(point, BENT, 0.15, 2)
    return LightTrial(point, score, scene, words, sharpening)


def _closer(search: CoordinateSearch, tried: LightTrial, found: LightTrial) -> LightTrial:
    return tried if closer(_unseen(search, tried), _unseen(search, found)) else found


def _unseen(search: CoordinateSearch, trial: LightTrial) -> Scores:
    search.replay = Replay.of(trial.scene, search.region)
    return search.unseen(trial.point)
