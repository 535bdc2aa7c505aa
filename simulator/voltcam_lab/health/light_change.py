"""What a recording's frames say of the light: where it changed, where it was at rest, how noisy it is."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..light.grey import USUAL_DARK_DN
from ..light.still import steady_pairs

_ROWS = 16
_STRETCH = 11
_SAMPLES = 200_000


@dataclass(frozen=True, eq=False)
class LightChange:
    """t_us: (N,) of the frames. noise_dn: standard deviation of a frame's grey level. mean_dn: (H, W).

    step: (N-1, H, W) float16, ln of the light of frame i+1 over frame i, 0 where it is no more than noise.
    at_rest: (N-1, H, W), as `light.still.steady_pairs`.
    """

    t_us: NDArray[np.int64]
    noise_dn: float
    mean_dn: NDArray[np.float32]
    step: NDArray[np.float16]
    at_rest: NDArray[np.bool_]

    @property
    def change(self) -> NDArray[np.float32]:
        """(H, W): all of a pixel's changes of ln L, up and down, added up."""
        return sum_over_time(self.step)

    @property
    def changing_share(self) -> float:
        """The share of pixels and intervals in which the light changed by more than noise."""
        return float(np.count_nonzero(self.step) / max(1, self.step.size))

    def changes(self) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
        """Grey level, |change of ln L| and its rate in 1/s, of up to _SAMPLES changes, evenly chosen."""
        places = np.flatnonzero(self.step)
        places = places[:: max(1, places.size // _SAMPLES)]
        interval, pixel = np.divmod(places, self.mean_dn.size)
        size = np.abs(self.step.ravel()[places]).astype(np.float32)
        seconds = np.diff(self.t_us)[interval] / 1e6
        return self.mean_dn.ravel()[pixel], size, (size / seconds).astype(np.float32)


def light_change_of(images: NDArray[np.uint8], t_us: NDArray[np.int64]) -> LightChange:
    """Of frames (N, H, W) [DN] at t_us (N,); N >= 2."""
    count, height, width = images.shape
    noise_dn = _noise_dn(images)
    step = np.empty((count - 1, height, width), np.float16)
    for top in range(0, height, _ROWS):
        band = images[:, top : top + _ROWS]
        grey = band.astype(np.float32)
        log_step = np.diff(np.log(grey + USUAL_DARK_DN), axis=0)
        log_step[np.abs(np.diff(grey, axis=0)) <= 3 * np.sqrt(2) * noise_dn + 1] = 0
        step[:, top : top + _ROWS] = log_step
    return LightChange(
        t_us, noise_dn, images.mean(0, dtype=np.float32), step, steady_pairs(images, t_us, noise_dn)
    )


def sum_over_time(step: NDArray[np.float16]) -> NDArray[np.float32]:
    """(N, H, W) -> (H, W), absolute values, without a copy of all of it."""
    total = np.zeros(step.shape[1:], np.float32)
    for plane in step:
        total += np.abs(plane)
    return total


def _noise_dn(images: NDArray[np.uint8]) -> float:
    """From the pixels and stretches of time that differ least from frame to frame, so that motion elsewhere
    does not count."""
    length = min(len(images), _STRETCH)
    starts = np.unique(np.linspace(0, len(images) - length, 12).astype(int))
    means = [
        np.abs(np.diff(images[start : start + length].astype(np.int16), axis=0)).mean(0, dtype=np.float32)
        for start in starts
    ]
    # Measured on a DAVIS346 at rest: the least twentieth is at 0.6 of the middle, from 10 differences each.
    mean = float(np.quantile(means, 0.05)) / 0.6
    return max(
        0.3, mean * float(np.sqrt(np.pi)) / 2
    )  # of a normal difference, the mean size is 2 sd/sqrt(pi)
