"""A search on scores that are formulas: no camera is simulated."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from voltcam_lab.calibration.refine.coordinate_search import CoordinateSearch
from voltcam_lab.calibration.refine.coordinates import ABSENT, Point, point_of
from voltcam_lab.calibration.refine.judge import DRAWS, Scores

from .made import START, wave

PLAIN = point_of(START) | ABSENT | {"k6": 1e-5, "delay_us": 1000.0, "period_us": 500.0}
SCENE = wave(0.05)
Score = Callable[[Point], float]


class MadeSearch(CoordinateSearch):
    """Both parts of the pixels have a formula in place of their score."""

    def __init__(self, seen: Score, unseen: Score | None = None) -> None:
        self.start, self.scene, self.said = START, SCENE, list[str]()
        self.report = self.said.append
        self._seen, self._unseen = seen, unseen or seen

    def residuals(self, point: Point) -> NDArray[np.float64]:
        return np.sqrt([self._seen(point)])

    def score(self, point: Point) -> float:
        return self._seen(point)

    def unseen(self, point: Point) -> Scores:
        return np.full((1, DRAWS), self._unseen(point))

    def _moving(self, point: Point) -> int:
        return round(100 * point["gain"])
