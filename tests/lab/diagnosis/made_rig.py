"""A rig without a simulator: what the battery sees is a formula, so that the search is tested alone."""

from collections.abc import Callable, Sequence

import numpy as np

from voltcam_lab.diagnosis.catalogue.catalogue import Candidate
from voltcam_lab.diagnosis.rig.rig import Rig, Values
from voltcam_lab.diagnosis.search.model import BASE
from voltcam_lab.statistics import FLOORS, PARTS
from voltcam_simulator import Parameters

START = Parameters.of("paper")
N = len(FLOORS)
PATTERNS = np.random.default_rng(7).standard_normal((12, PARTS, N)) * np.maximum(FLOORS, 1)
"""Directions in what the battery sees: the first six are those of the base parameters."""

DEAD_TIME = Candidate("refractory_period", ("period_us",), ((700.0,), (3000.0,)))
MISMATCH = Candidate("threshold_mismatch", ("sigma",), ((0.1,),))
DEAD = Candidate("dead_pixels", ("fraction",), ((0.01,),))
CATALOGUE = (DEAD_TIME, MISMATCH, DEAD)


def logs(parameters: Parameters) -> np.ndarray:
    """Of the base parameters, from where they start."""
    values = [getattr(getattr(parameters, e), n) / getattr(getattr(START, e), n) for e, n in BASE]
    return np.log(values)


def response(parameters: Parameters) -> Values:
    """Base parameters and three effects, each along its own pattern."""
    amounts = [
        *(10 * logs(parameters)),
        parameters.refractory_period.period_us / 1000,
        10 * parameters.threshold_mismatch.sigma,
        100 * parameters.dead_pixels.fraction,
    ]
    return 100 + np.tensordot(amounts, PATTERNS[: len(amounts)], 1)


class MadeRig(Rig):
    """Sees `response` and noise of its own, as large as the floors."""

    def __init__(self, response: Callable[[Parameters], Values] = response) -> None:
        self._response = response

    def run(self, parameters: Parameters, seeds: Sequence[int], apart: bool = False) -> Values:
        seen = self._response(parameters)
        return np.stack([seen + self.noise(seed) for seed in seeds])

    def noise(self, seed: int) -> Values:
        return np.random.default_rng(seed).standard_normal((PARTS, N)) * np.maximum(FLOORS, 1)
