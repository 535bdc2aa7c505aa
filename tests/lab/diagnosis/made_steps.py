"""Steps and trials of a search whose gaps are written down."""

import numpy as np

from voltcam_lab.diagnosis.catalogue.candidate import Candidate
from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.screen import Screen
from voltcam_lab.diagnosis.search.settings import DEFAULTS
from voltcam_lab.diagnosis.search.spread import TwinSpread
from voltcam_lab.diagnosis.search.step import SearchStep
from voltcam_lab.diagnosis.search.trial import Trial
from voltcam_lab.statistics import PARTS

from .made_rig import START

N, FLOOR = 100, 0.5
"""Statistics of a part; the gap that chance leaves."""
SIZE = 3 * N
"""Statistics in the three training parts."""


def trial(candidate: Candidate, left: float, confirmed: float | None = None, shift: float = 0.0) -> Trial:
    """Leaves an excess of `left` of 4. confirmed: gain on held-out data, by default as in training."""
    hypothesis = Hypothesis(START).with_effect(candidate, candidate.sizes[0])
    gained = 4.0 - left
    mean = np.full((PARTS, N), shift)
    return Trial(
        candidate, hypothesis, mean, 1.0, FLOOR + left, FLOOR + left, gained,
        gained if confirmed is None else confirmed,
    )  # fmt: skip


def step(excess: float, *trials: Trial, added: Candidate | None = None, held_out: float = 4.0) -> SearchStep:
    """Deviations all alike, of which chance leaves nothing. An added effect moves no statistic."""
    mean, sd = np.zeros((PARTS, N)), np.ones((PARTS, N))
    spread = TwinSpread(mean, sd, mean, sd, [], mean[..., None], 4, mean)
    hypothesis = Hypothesis(START) if added is None else Hypothesis(START).with_effect(added, added.sizes[0])
    screen = Screen(hypothesis, spread, mean[..., None], (), DEFAULTS, np.ones(N, np.bool_))
    return SearchStep(
        hypothesis, screen, rest=np.full((PARTS, N), 2.0), chance=np.zeros((PARTS, N)),
        training=FLOOR + excess, held_out=FLOOR + held_out, floor_training=FLOOR, floor_held_out=FLOOR,
        scores=np.ones(1), p_value=1e-3, least=30.0, trials=trials,
    )  # fmt: skip
