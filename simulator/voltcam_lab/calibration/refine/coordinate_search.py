"""The search of `refine`: coordinates one by one, in the end together, with the same random numbers."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from voltcam_simulator import Parameters

from ...distances import Region
from ...distances.goal import Goal
from ...light.grey import WHITE_DN
from ...light.scene import Scene
from .coordinates import ABSENT, CORE, OFFERED, Point, parameters_at, present, with_curvature
from .judge import Judge, Scores, closer
from .replay import Replay

ALIKE = 0.002  # of the score: polishing that gains less is at its end
CLOSE = 1.05  # times the best score: what is further off is not looked at again
POLISHING = 8  # steps of all coordinates at once, at most; two or three are usual
WIDE = 0.08  # of a logarithm, to either side: over that slopes are taken
STAYING = 0.03  # residual of a factor of e: a coordinate that changes nothing stays where it is
FAR = 1e3  # residual of what is no camera
HALVINGS = 6  # of a factor of 2: to 1 %
SLOWER = {
    "cutoff_hz": 2e6,
    "follower_hz": 1e6,
}  # us, over 2 pi f: how late a pole is, half as bright as white


@dataclass
class CoordinateSearch:
    """Steps are judged by `seen`; what is new stays if it is closer to `judge`, whose pixels saw none."""

    start: Parameters
    seen: Goal
    judge: Judge
    scene: Scene
    region: Region
    seed: int
    report: Callable[[str], None]

    def __post_init__(self) -> None:
        self.replay = Replay.of(self.scene, self.region)

    def score(self, point: Point) -> float:
        """What steps are judged by; inf where there is no such camera."""
        if point["knee_dn"] > WHITE_DN:  # of no consequence any more
            return math.inf
        try:
            return self.seen.score(self._events(point))
        except ValueError:
            return math.inf

    def residuals(self, point: Point) -> NDArray[np.float64]:
        """What `score` is the squares of. Raises ValueError where there is no such camera."""
        return self.seen.residuals(self._events(point))

    def unseen(self, point: Point) -> Scores:
        """What decides whether something new stays."""
        return self.judge.scores(self.replay, parameters_at(point, self.start))

    def _events(self, point: Point) -> NDArray[np.void]:
        return self.replay.events(parameters_at(point, self.start), self.seed)

    def moved(
        self, point: Point, names: tuple[str, ...], size: float, rounds: int, best: float | None = None
    ) -> tuple[dict[str, float], float]:
        """Coordinate search: each name up and down by its step, which grows with what helps and shrinks with
        what does not. Returns the best point, and its score."""
        point, best = dict(point), self.score(point) if best is None else best
        sizes = dict.fromkeys(names, size)
        for _ in range(rounds):
            for name in names:
                for sign in (1, -1):
                    tried = self._with(point, name, point[name] * math.exp(sign * sizes[name]))
                    value = self.score(tried)
                    if value < best:
                        point, best, sizes[name] = tried, value, sign * sizes[name] * 1.4
                        break
                else:
                    sizes[name] *= 0.4
        return point, best

    def first(self, point: Point) -> dict[str, float]:
        """What the likelihood took for noise may be error of the light: without, if that is closer."""
        self.report("refine: noise")
        point = dict(point) | {"period_us": max(point["period_us"], 100.0)}
        point, best = self.moved(point, ("gain",), 0.3, 2)
        for names in (("reset_spread",), ("k3", "k6"), ("k4_per_us", "k5_per_dn_us"), ("threshold_spread",)):
            for share in (0.0, 0.3):
                tried = point | {name: share * point[name] for name in names}
                value = self.score(tried)
                if value < best:
                    point, best = tried, value
        self.report("refine: thresholds")
        return self.moved(point, CORE, 0.3, 6, best)[0]

    def end(self, point: dict[str, float], name: str, sizes: tuple[float, ...]) -> dict[str, float]:
        """The point with this coordinate near one of the sizes, if that is closer; all else stays."""
        first = min((point | {name: size} for size in sizes), key=self.score)
        return self._closer(self.moved(first, (name,), 0.2, 6)[0], point)

    def settled(self, point: dict[str, float]) -> dict[str, float]:
        """The point polished once more where what black and white stand for, spread and slack are found: they
        stay as they are."""
        offered = (name for name, _ in OFFERED if name != "threshold_spread")
        names = tuple(name for name in (*CORE, *offered) if point[name] > 0)
        return self._closer(self.polished(point, names), point)

    def traded(self, point: dict[str, float], name: str, sizes: Sequence[float]) -> dict[str, float]:
        """The point with this coordinate at one of the sizes, if that is closer.

        The gain makes up for what that takes: as many events come of light that moves as before.
        """
        moving = self._moving(point)
        tries = (self._making(moving, point | {name: size}) for size in sizes)
        return self._closer(min(tries, key=self.score), point)

    def _closer(self, tried: dict[str, float], point: dict[str, float]) -> dict[str, float]:
        """What was tried, if it is closer on pixels that saw no steps; else the point."""
        near = self.score(tried) < self.score(point) * CLOSE
        return tried if near and closer(self.unseen(tried), self.unseen(point)) else point

    def _moving(self, point: Point) -> int:
        """Events of light that moves."""
        return self.seen.moving(self._events(point))

    def _making(self, moving: int, point: dict[str, float]) -> dict[str, float]:
        """The point with the gain, up to twice its own, of which so many events come."""
        low, high, tried = 0.0, math.log(2), point
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            tried = point | {"gain": point["gain"] * math.exp(middle)}
            low, high = (middle, high) if self._moving(tried) < moving else (low, middle)
        return tried

    def offered(self, point: dict[str, float]) -> dict[str, float]:
        """The point with those mechanisms that help pixels which did not choose them.

        Those that are there are offered, too: steps on a logarithm never leave a size of next to none.
        """
        best, unseen = self.score(point), self.unseen(point)
        for name, values in OFFERED:
            self.report(f"refine: {name}")
            changed = [self._with(point, name, x) for x in values]
            if name in SLOWER:  # contrast that comes too fast is lost: the gain makes up for it
                moving = self._moving(point)
                changed = [self._making(moving, tried) for tried in changed]
            value, tried = min(((self.score(tried), tried) for tried in changed), key=lambda each: each[0])
            if value >= best * CLOSE:
                continue
            tried, value = self.moved(tried, (name, "gain"), 0.2, 2, value)
            other = self.unseen(tried)
            if closer(other, unseen):
                point, best, unseen = tried, value, other
        return point

    def _with(self, point: dict[str, float], name: str, value: float) -> dict[str, float]:
        """A mechanism at a size; what it makes late is taken from the delay, what it bends from the gain."""
        if name == "gamma":
            return with_curvature(point, value, point["knee_dn"])
        if name == "knee_dn":
            return with_curvature(point, point["gamma"], value)
        changed = point | {name: value}
        if name in SLOWER:
            periods_s = 1 / (value or math.inf) - 1 / (point[name] or math.inf)
            changed["delay_us"] = point["delay_us"] - SLOWER[name] / (2 * math.pi) * periods_s
        return changed

    def polished(self, point: dict[str, float], names: tuple[str, ...]) -> dict[str, float]:
        """All at once, by least squares on logarithms: coordinates that make up for one another stop steps
        one by one. Slopes are over wide steps, since noise misleads narrow ones."""
        self.report("refine: all")
        origin = np.array([math.log(point[name]) for name in names])
        first = self.residuals(point)

        def residuals(moved: NDArray[np.float64]) -> NDArray[np.float64]:
            there = self._at(point, names, origin + moved - 1)
            try:
                found = self.residuals(there) if there["knee_dn"] <= WHITE_DN else first + FAR
            except ValueError:  # no such camera
                found = first + FAR
            return np.concatenate([found, STAYING * (moved - 1)])

        found = least_squares(
            residuals, np.ones(len(names)), "3-point", diff_step=WIDE, ftol=ALIKE, max_nfev=POLISHING
        )
        return self._at(point, names, origin + found.x - 1)

    def _at(
        self, point: dict[str, float], names: tuple[str, ...], log: NDArray[np.float64]
    ) -> dict[str, float]:
        """The point with these coordinates, by their logarithms. Others that make up for them follow."""
        for name, value in zip(names, np.exp(log).tolist(), strict=True):
            point = self._with(point, name, value)
        return point

    def without_needless(self, point: dict[str, float]) -> dict[str, float]:
        """Less those mechanisms that are not missed by more than chance."""
        self.report("refine: what is needed")
        unseen = self.unseen(point)
        for name in present(point):
            tried = self._with(point, name, ABSENT[name])
            without = self.unseen(tried)
            if not closer(unseen, without):
                point, unseen = tried, without
        return point
