"""The maximum of a log likelihood that comes in parts."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
STEP = 1e-5  # of a logarithm, for derivatives
LONGEST = 1.0  # no parameter goes further than a factor e at once


@dataclass(frozen=True, eq=False)
class Prior:
    """Independent normal priors: centre and sd, each (k,)."""

    centre: Vector
    sd: Vector

    def pull(self, x: Vector) -> Vector:
        """Gradient of the log prior."""
        return (self.centre - x) / self.sd**2

    def of(self, x: Vector) -> float:
        """The log prior."""
        return float(-0.5 * (((x - self.centre) / self.sd) ** 2).sum())


def scores(parts: Callable[[Vector], Vector], x: Vector) -> NDArray[np.float64]:
    """(k, n): derivative of each part with respect to each of x (k,), by differences."""
    here = parts(x)
    return np.array([(parts(x + STEP * unit) - here) / STEP for unit in np.eye(len(x))])


def ascend(
    parts: Callable[[Vector], Vector],
    x: Vector,
    prior: Prior,
    steps: int = 25,
    tolerance: float = 1e-2,
    counts: Vector | float = 1.0,
) -> Vector:
    """The x (k,) at which the sum of `parts` and the log prior is largest.

    Scoring (Berndt, Hall, Hall, Hausman 1974): the information is the sum of the parts' score products,
    damped as Levenberg and Marquardt do. Ends when a step gains less than `tolerance` of log likelihood.
    counts: of how many alike each part is the sum.
    """
    damping, best = 1e-3, float(parts(x).sum()) + prior.of(x)
    for _ in range(steps):
        score = scores(parts, x)
        gradient = score.sum(axis=1) + prior.pull(x)
        information = (score / counts) @ score.T + np.diag(prior.sd**-2.0)
        while damping < 1e6:
            step = np.linalg.solve(information + damping * np.diag(np.diag(information)), gradient)
            step /= max(1.0, float(np.abs(step).max()) / LONGEST)
            value = float(parts(x + step).sum()) + prior.of(x + step)
            if value > best:
                break
            damping *= 10
        else:
            return x
        gain, x, best, damping = value - best, x + step, value, damping / 10
        if gain < tolerance:
            break
    return x
