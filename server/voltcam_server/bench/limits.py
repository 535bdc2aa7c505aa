"""What the speeds of `voltcam bench` are held against: the machine's limits, and the same in plain numpy."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Self

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters

from .figure import Figure, Frames, repeated


@dataclass(frozen=True)
class MachineLimits:
    """How fast memory is copied and 64-bit numbers are sorted here: medians of `figures`."""

    figures: list[Figure]

    @classmethod
    def measured(cls) -> Self:
        """Measure them now."""
        source = np.ones(64 * 2**20, np.uint8)
        target = np.empty_like(source)
        copies = repeated(lambda: np.copyto(target, source))
        keys = np.random.default_rng(1).integers(0, 2**62, 100_000).astype(np.uint64)
        sorts = repeated(lambda: np.sort(keys))
        return cls([
            Figure.of("limit: memory copy", [source.size / s / 1e9 for s in copies], "GB/s"),
            Figure.of("limit: sort of 64-bit numbers", [s / keys.size * 1e9 for s in sorts], "ns/event"),
        ])  # fmt: skip

    def seconds(self, copied_bytes: float, events: float) -> float:
        """The least time in which so many bytes are read and written once, and so many events sorted."""
        copy_gb_per_s, sort_ns = (figure.median for figure in self.figures)
        return copied_bytes / (copy_gb_per_s * 1e9) + events * sort_ns * 1e-9


def numpy_paper_law(frames: Frames) -> list[Figure]:
    """The paper's Algorithm 1 for whole planes in plain numpy, one pass a frame, events not even sorted."""
    rng = np.random.default_rng(1)
    k = Parameters.of("paper")

    def frame_pair(
        first: NDArray[np.float64], last: NDArray[np.float64], residual: NDArray[np.float64]
    ) -> None:
        span = 1e6 / 240
        level, k2 = 0.5 * (first + last), k.contrast_response.k2_dn
        mu = k.contrast_response.k1 * (last - first) / span / (level + k2)
        mu += k.junction_leak.k4_per_us + k.parasitic_photocurrent.k5_per_dn_us * level
        sigma = k.photon_noise.k3 * np.sqrt(level) / (level + k2) + k.leak_noise.k6
        distance = np.where(mu > 0, 1 - residual, 1 + residual)
        mean, shape = distance / np.abs(mu), (distance / sigma) ** 2
        tau = rng.wald(mean, shape)
        fired = tau < span
        residual[:] = np.where(fired, 0, residual + np.sign(mu) * distance * span / tau)

    planes = frames.astype(np.float64)
    residual = np.zeros_like(planes[0])

    def all_frames() -> None:
        for first, last in pairwise(planes):
            frame_pair(first, last, residual)

    seconds = repeated(all_frames)
    pixels = frames[1:].size
    name = "346x260 moving, paper law in plain numpy"
    return [
        Figure.of(name, [pixels / s / 1e6 for s in seconds], "Mpx/s", "one event a pixel and frame at most")
    ]
