"""Which of two cameras is closer to a recording, by more than chance."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from voltcam_simulator import Parameters

from ...distances.goal import Goal
from .replay import Replay

DRAWS = 5  # simulations of each camera: each has thresholds and noise of its own
SURE = 0.95

Scores = NDArray[np.float64]
"""(G, DRAWS): by goal and draw; the same draw has the same random numbers for any camera."""


@dataclass(frozen=True, eq=False)
class Judge:
    """goals: of pixels that no step was judged by, the one that decides first. seed: of the steps; draws have
    other ones, as what was chosen by one draw is better in that than in any other."""

    goals: tuple[Goal, ...]
    seed: int

    def scores(self, replay: Replay, parameters: Parameters) -> Scores:
        """Of a camera."""
        draws = (replay.events(parameters, self.seed + 1 + draw) for draw in range(DRAWS))
        return np.array([[goal.score(events) for goal in self.goals] for events in draws]).T


def closer(tried: Scores, other: Scores) -> bool:
    """Whether a camera has lower scores than another by more than draws differ (Student's t, one-sided).

    A goal that cannot tell leaves it to the next one. Where none can tell it is False.
    """
    change = tried - other
    mean = change.mean(axis=1)
    reach = student.ppf(SURE, DRAWS - 1) * change.std(axis=1, ddof=1) / np.sqrt(DRAWS)
    told = np.flatnonzero(np.abs(mean) > reach)
    return bool(told.size and mean[told[0]] < 0)
