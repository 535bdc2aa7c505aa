"""Halves of a recording: how bright pixels are in each, how much light changes, and how much there was."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

HALVES = 2
BRIGHTNESS, CHANGE = ("dark", "middle", "bright"), ("less", "more")


@dataclass(frozen=True, eq=False)
class Halves:
    """middle_us: where the first one ends. cell: (HALVES, K), by brightness in thirds of the pixels, then by
    change in halves. dose: (N, K) float32 of light from the begin [DN s]."""

    middle_us: int
    cell: NDArray[np.int64]
    dose: NDArray[np.float32]

    def dose_at(self, scene_us: NDArray[np.int64], t_us: NDArray[np.int64], k: NDArray[Any]) -> NDArray[Any]:
        """(n,) of pixels k at times t_us, both (n,). scene_us: (N,) of `dose`."""
        step = np.clip(np.searchsorted(scene_us, t_us, side="right") - 1, 0, len(scene_us) - 2)
        share = (t_us - scene_us[step]) / (scene_us[step + 1] - scene_us[step])
        dose: NDArray[Any] = (1 - share) * self.dose[step, k] + share * self.dose[step + 1, k]
        return dose


def halves_of(light: NDArray[np.float32], log_light: NDArray[np.float32], t_us: NDArray[np.int64]) -> Halves:
    """Of K pixels at N instants: light (N, K) [DN], log_light (N, K) is ln(L + k2)."""
    seconds = np.diff(t_us).astype(np.float32)[:, None] * np.float32(1e-6)
    dose = np.zeros(light.shape, np.float32)
    np.cumsum(0.5 * (light[1:] + light[:-1]) * seconds, axis=0, out=dose[1:])
    middle_us = int(t_us[0] + t_us[-1]) // 2
    middle = int(np.searchsorted(t_us, middle_us))
    cell = np.zeros((HALVES, light.shape[1]), np.int64)
    for half, (begin, end) in enumerate(((0, middle), (middle, len(t_us) - 1))):
        bright = _ranked(dose[end] - dose[begin], len(BRIGHTNESS))
        change = np.abs(np.diff(log_light[begin : end + 1], axis=0)).sum(axis=0)
        cell[half] = bright * len(CHANGE) + _ranked(change, len(CHANGE))
    return Halves(middle_us, cell, dose)


def _ranked(value: NDArray[Any], classes: int) -> NDArray[np.int64]:
    """Of which of so many classes of equal size each is, the lowest first."""
    rank = np.argsort(np.argsort(value, kind="stable"), kind="stable")
    return np.asarray(rank * classes // max(len(value), 1), np.int64)
