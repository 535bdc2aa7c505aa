"""The grid: what is hidden in which recording."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from tests.generator import (
    FAULTS,
    LEVELS,
    LISTED,
    STRAIGHT,
    UNLISTED,
    Base,
    Effect,
    Film,
    Recorded,
    draw_base,
    draw_effect,
    draw_film,
    draw_fine_scene,
    draw_photo_scene,
    record,
    shuffled_polarity,
)

from .makes import MAKES, made

Sabotage = Literal["deleted", "shuffled"]
SceneKind = Literal["plane waves", "photographs"]

REPORTED_FROM = 43_000  # below it is development; earlier grids: 9000 on, and thousands from 31 to 42
SCENES = {"plane waves": draw_fine_scene, "photographs": draw_photo_scene}
_PLAIN = LEVELS[1:]
SINGLES, FURTHER = LISTED[:14], LISTED[14:]  # those with asked figures, and the rest of the catalogue
ON_K4 = (
    "leak_mismatch",
    "temperature_drift",
)  # act on the junction's leak alone: too little of it in a DAVIS240C
WIDTH, HEIGHT, SECONDS = 48, 36, 6.0
FPS, ANY_FPS, SLOW_FPS, BLURRED_FPS = 200.0, (25.0, 200.0), (25.0, 40.0), 60.0  # 15 ms do not fit into 5


@dataclass(frozen=True)
class Case:
    """A recording to be made and diagnosed. effects: (name, level) by the generator's names.

    Nulls have frames at FPS, slow nulls at SLOW_FPS, all others at ANY_FPS.
    """

    name: str  # part/what/..., unique in the grid
    seed: int = 0
    scene: SceneKind = "plane waves"
    effects: tuple[tuple[str, str], ...] = ()
    fault: str | None = None  # of the frames, one of FAULTS
    sabotage: Sabotage | None = None
    make: str | None = None  # of MAKES, with effects of its own

    @property
    def part(self) -> str:
        """Of the grid."""
        return self.name.partition("/")[0]


@dataclass(frozen=True, eq=False)
class Drawn:
    """What a case's seed stands for, beside the scene: the answer is in it."""

    base: Base
    effects: tuple[Effect, ...]
    film: Film
    fps: float


def grid(seed: int) -> tuple[Case, ...]:
    """All cases, their seeds from `seed` on. Parts are mixed evenly: any beginning is a small grid; makes are
    last."""
    rng = np.random.default_rng(seed)
    parts = [_on_scenes(part, rng) for part in _parts(rng)]
    places = [((n + 0.5) / len(part), which) for which, part in enumerate(parts) for n in range(len(part))]
    remaining = [iter(part) for part in parts]
    order = [next(remaining[which]) for _, which in sorted(places)]
    order += _on_scenes([Case(f"makes/{make}", make=make) for make in MAKES], rng)
    return tuple(replace(case, seed=seed + n) for n, case in enumerate(order))


def _on_scenes(part: list[Case], rng: np.random.Generator) -> list[Case]:
    """Each kind of scene for as many cases, whatever is hidden in them."""
    kinds = tuple(SCENES)
    which = rng.permutation(np.arange(len(part)) % len(kinds))
    return [replace(case, scene=kinds[n]) for case, n in zip(part, which, strict=True)]


def _parts(rng: np.random.Generator) -> Iterator[list[Case]]:
    """Each part's cases, without seeds: as many as the sketch of section 5 had, or more."""
    yield _each("singles", SINGLES, LEVELS, 0) + _each("singles", SINGLES, _PLAIN, 1)
    yield _each("further", FURTHER, LEVELS, 0)
    yield _each("unlisted", UNLISTED, _PLAIN, 0) + _each("unlisted", UNLISTED, _PLAIN, 1)
    yield [Case(f"nulls/{n}") for n in range(100)]
    yield [Case(f"slow nulls/{n}") for n in range(50)]
    yield _pairs(rng, 2)
    yield [Case(f"misspecified/{fault}/{n}", fault=fault) for n in range(2) for fault in FAULTS]
    yield [Case(f"shuffled/{n}", sabotage="shuffled") for n in range(4)]
    yield [Case(f"deleted/{one}", effects=((one, "strong"),), sabotage="deleted") for one in SINGLES]


def _each(part: str, effects: tuple[str, ...], levels: tuple[str, ...], n: int) -> list[Case]:
    """Each effect once at each level, the n-th time. Levels take turns."""
    return [
        Case(f"{part}/{effect}/{level}/{n}", effects=((effect, level),))
        for turn in range(len(levels))
        for place, effect in enumerate(effects)
        for level in [levels[(place + turn) % len(levels)]]
    ]


def _pairs(rng: np.random.Generator, rounds: int) -> list[Case]:
    """Each effect once a round, medium or strong."""
    pairs: list[Case] = []
    for n in range(rounds):
        for two in rng.permutation(SINGLES).reshape(-1, 2).tolist():
            effects = tuple((effect, str(rng.choice(["medium", "strong"]))) for effect in sorted(two))
            pairs.append(Case(f"pairs/{'+'.join(sorted(two))}/{n}", effects=effects))
    return pairs


def drawn(case: Case) -> Drawn:
    """Base parameters (each k off by up to 30 %), effects and frames of a case."""
    rng = _streams(case)[0]
    camera = "davis346" if any(name in ON_K4 for name, _ in case.effects) else None
    base = draw_base(rng, asymmetry=0.0, camera=camera)
    effects = tuple(draw_effect(rng, name, level) for name, level in case.effects)
    film = draw_film(rng, case.fault) if case.fault else STRAIGHT
    return Drawn(base, effects, film, _frames_per_s(case, film, rng))


def _frames_per_s(case: Case, film: Film, rng: np.random.Generator) -> float:
    if case.part == "nulls":
        return FPS
    if film.exposure_us > 0:
        return BLURRED_FPS
    return float(np.exp(rng.uniform(*np.log(SLOW_FPS if case.part == "slow nulls" else ANY_FPS))))


def recorded(case: Case) -> Recorded:
    """The recording, frames of 8 bit. Its `truth` is for nobody to see."""
    scene = SCENES[case.scene](_streams(case)[1], WIDTH, HEIGHT)
    if case.make:
        return made(MAKES[case.make], scene, SECONDS, FPS, case.seed)
    what = drawn(case)
    recording = record(scene, what.base, what.effects, SECONDS, what.fps, seed=case.seed, film=what.film)
    return shuffled_polarity(recording, case.seed) if case.sabotage == "shuffled" else recording


def _streams(case: Case) -> list[np.random.Generator]:
    return np.random.default_rng(case.seed).spawn(2)
