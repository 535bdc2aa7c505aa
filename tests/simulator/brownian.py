"""Independent oracles for Brownian motion in a band: a slow fine-step simulation and closed forms."""

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid

from voltcam_simulator.crossings import cross
from voltcam_simulator.effect import STRAIGHT
from voltcam_simulator.groups import Kicks, Motion, Pixels, Reset, Step
from voltcam_simulator.random import CROSSINGS, interval_key

Floats = NDArray[np.float64]
SPAN_US = 1_000_000.0


def crossings(
    n: int, start: float, drift: float, noise: float, above: float, below: float, seed: int = 1
) -> tuple[NDArray[np.int64], Floats, NDArray[np.bool_], NDArray[np.float32]]:
    """n pixels over one second by the kernel: (pixel, time [s], ON?) of all events, and end voltages.

    drift and noise (standard deviation) are those of the whole second.
    """
    levels = (start, 0, 0, above, below)
    pixels = Pixels(*(np.full(n, level, np.float32) for level in levels))
    motion = Motion(*(np.full(n, v, np.float32) for v in (drift, noise / np.sqrt(SPAN_US))))
    step = Step(interval_key(seed, CROSSINGS, 0), SPAN_US, 0.0, first_pixel=0, width=n)
    kicks = Kicks(np.zeros((0, 1)), np.zeros((0, 1)), np.zeros(n, np.float32))
    keys = np.empty(2000 * n if noise > 2 else 200 * n, np.uint64)
    near, bent = np.arange(n, dtype=np.int32), np.empty(0, np.int32)
    done, written = cross(
        *pixels, *motion, *step, *Reset(0.0, 0.0), *kicks, *STRAIGHT, False, near, bent, 0, keys
    )
    assert done == n
    keys = keys[:written]
    pixel = (keys >> np.uint64(1) & np.uint64(0x1FFF)).astype(np.int64)
    return pixel, (keys >> np.uint64(27)) / SPAN_US, (keys & np.uint64(1)).astype(bool), pixels.voltage


def bent_path(drift: float, transient: float, rate: float, share: Floats) -> Floats:
    """The mean path from 0 to drift, at shares of the second: a line and transient exp(-rate share)."""
    curve = np.exp(-rate * share)
    return np.asarray(drift * share + transient * (curve - 1 + share * (1 - np.exp(-rate))))


def fine_steps(
    n: int,
    start: float,
    drift: float | Floats,
    noise: float,
    above: float,
    below: float,
    steps: int,
    seed: int = 2,
) -> tuple[NDArray[np.int64], Floats, NDArray[np.bool_], Floats]:
    """The same by brute force; drift may be the mean path at the ends of all steps.

    Barriers are moved inwards by .5826 standard deviations of a step, which takes out the leading error of
    looking at discrete times only (Broadie, Glasserman and Kou 1997).
    """
    rng = np.random.default_rng(seed)
    voltage = np.full(n, start)
    gained = np.diff(drift, prepend=0.0) if isinstance(drift, np.ndarray) else np.full(steps, drift / steps)
    inwards = 0.5826 * noise / np.sqrt(steps)
    found: list[tuple[NDArray[np.int64], Floats, NDArray[np.bool_]]] = []
    for step in range(steps):
        voltage += gained[step] + noise / np.sqrt(steps) * rng.standard_normal(n)
        on, off = voltage >= above - inwards, voltage <= inwards - below
        pixels = np.flatnonzero(on | off)
        found.append((pixels, np.full(pixels.size, (step + 0.5) / steps), on[pixels]))
        voltage[on] -= above
        voltage[off] += below
    pixel, time, polarity = (np.concatenate(column) for column in zip(*found, strict=True))
    return pixel, time, polarity, voltage


def first_exit_cdf(
    t: Floats, start: float, drift: float, noise: float, above: float, below: float
) -> tuple[Floats, Floats]:
    """P(first exit is ON and before t), P(first exit is OFF and before t); Borodin and Salminen 3.0.6.

    The density of leaving at the top at t is exp(mu d / s^2 - mu^2 t / 2 s^2) times a sum over images of the
    driftless one. t must start near 0 and be dense.
    """

    def density(distance: float) -> Floats:
        band = above + below
        images = distance + 2 * band * np.arange(-50, 51)[:, None]
        terms = images / np.sqrt(2 * np.pi * t**3) / noise * np.exp(-(images**2) / (2 * noise**2 * t))
        return np.asarray(terms.sum(0) * np.exp(-(drift**2) * t / (2 * noise**2)))

    up, down = above - start, start + below
    on = np.exp(drift * up / noise**2) * density(up)
    off = np.exp(-drift * down / noise**2) * density(down)
    return cumulative_trapezoid(on, t, initial=0), cumulative_trapezoid(off, t, initial=0)
