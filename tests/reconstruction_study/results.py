"""What was measured, from the files that the runs left."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .contenders import ABLATIONS, MODELS

MEASURES = ("mse", "ssim", "mse_equalised", "ssim_equalised")
BETTER = {"mse": min, "ssim": max, "mse_equalised": min, "ssim_equalised": max}


@dataclass(frozen=True)
class Run:
    """One network. measured: by recording, then by measure."""

    model: str
    seed: int
    budget: dict[str, Any]
    events: int
    took_s: float
    losses: list[float]
    measured: dict[str, dict[str, float]]
    machine: str = ""


def folder_of(work: Path, model: str) -> Path:
    return work / model.replace(" ", "_").replace(",", "")


def runs(work: Path) -> list[Run]:
    """All that are finished, in the order of contenders and seeds."""
    found = [Run(**json.loads(path.read_text())) for path in work.glob("*/seed_*.json")]
    names = MODELS + ABLATIONS
    return sorted(found, key=lambda run: (names.index(run.model), run.seed))


def values(found: list[Run], model: str, recording: str, measure: str) -> NDArray[np.float64]:
    """One for each seed."""
    return np.array([run.measured[recording][measure] for run in found if run.model == model])


def separated(found: list[Run], a: str, b: str, recording: str, measure: str) -> bool:
    """Whether every network of a is better than every network of b."""
    one, other = _more_is_better(found, a, b, recording, measure)
    return bool(one.min() > other.max())


def ahead_by_seed(found: list[Run], a: str, b: str, recording: str, measure: str) -> bool:
    """Whether a is better with each seed: the same weights at the begin, and clips in the same order."""
    one, other = _more_is_better(found, a, b, recording, measure)
    count = min(len(one), len(other))
    return bool((one[:count] > other[:count]).all())


def _more_is_better(
    found: list[Run], a: str, b: str, recording: str, measure: str
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    sign = -1 if BETTER[measure] is min else 1
    return sign * values(found, a, recording, measure), sign * values(found, b, recording, measure)
