"""A rig without a simulator: the statistics are a formula, so that the search is tested alone."""

from collections.abc import Callable, Sequence

import numpy as np

from voltcam_lab.diagnosis.catalogue.candidate import Candidate
from voltcam_lab.diagnosis.catalogue.clues import Clues
from voltcam_lab.diagnosis.rig.rig import Rig
from voltcam_lab.diagnosis.rig.settings import DEFAULT_RIG
from voltcam_lab.diagnosis.search.hypothesis import BASE
from voltcam_lab.light.scene import scene_of
from voltcam_lab.statistics import FLOORS, PARTS, Values, setting_of
from voltcam_simulator import EVENT, Parameters

START = Parameters.of("paper")
N = len(FLOORS)


def drawn(seed: int, *shape: int) -> Values:
    """(*shape, N) normal numbers, as large as the floors. One statistic more leaves the others alone."""
    rows = np.random.default_rng(seed).standard_normal((N, *shape))
    values: Values = np.moveaxis(rows, 0, -1) * np.maximum(FLOORS, 1)
    return values


PATTERNS = drawn(1, 12, PARTS)
"""Directions in the statistics: the first six are those of the base parameters."""

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
        self._response, self.settings = response, DEFAULT_RIG

    @property
    def light_is_guessed(self) -> bool:
        return False

    def run(
        self, parameters: Parameters, seeds: Sequence[int], apart: bool = False, noisier: bool = False
    ) -> Values:
        seen = self._response(parameters)
        return np.stack([seen + self.noise(seed) for seed in seeds])

    def noise(self, seed: int) -> Values:
        return drawn(seed, PARTS)


def made_clues() -> Clues:
    """Of 6 s of 48 x 36 pixels with an event in each 20 us."""
    t_us = np.arange(0, 6_000_001, 40_000)
    scene = scene_of(np.full((len(t_us), 36, 48), 100, np.float32), t_us, "cubic")
    events = np.zeros(300_000, EVENT)
    events["t"] = np.arange(len(events)) * 20 + 1
    return Clues(setting_of(scene, t_us, parameters=START), events, 35.25)


def swaying() -> Rig:
    """2 s of 16 x 12 pixels whose light goes up and down, 200 frames a second."""
    t_us = np.arange(0, 2_000_001, 5000)
    grey = 100 + 60 * np.sin(2e-6 * np.pi * t_us[:, None, None] + np.arange(16) * 0.4 + np.zeros((12, 1)))
    return Rig(setting_of(scene_of(grey.astype(np.float32), t_us, "cubic"), t_us, parameters=START))
