"""A scene as continuous light: radiance at any time and pixel, with rest, slow and fast motion interleaved.

A textured plane slides and turns behind a static shading; hard-edged discs fly across it; in front of both
hang static cards of every brightness. All motion keeps one schedule: each half second has all three paces.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .kernel import FINENESS, paint
from .pixels import Canvas

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

TEXTURE = 512  # samples a side of the periodic texture
DARKEST, BRIGHTEST = 10.0, 230.0  # DN
LEAD_US = 1_000_000  # the schedule begins this long before time 0, and ends this long after its last second
GRID_US = 100  # the path is summed on this grid


@dataclass(frozen=True)
class Scene:
    width: int
    height: int
    seconds: float
    canvas: Canvas
    path: Floats  # (times, 4 + 2 discs): shift x, y [px], cos, sin of the turn, centres of the discs [px]
    speed: Floats  # (times,) px/s of the plane, for whoever wants to know the pace

    def poses(self, t_us: NDArray[np.int64] | Floats) -> Floats:
        """(times, 4 + 2 discs) at any times, in microseconds from -1 s to 1 s past the end."""
        at = (np.asarray(t_us, float) + LEAD_US) / GRID_US
        if at.min() < 0 or at.max() > len(self.path) - 1:
            raise ValueError(f"the scene lasts {self.seconds} s: draw_scene(seconds=...) draws a longer one")
        low = np.minimum(at.astype(np.int64), len(self.path) - 2)
        share = (at - low)[:, None]
        return np.ascontiguousarray((1 - share) * self.path[low] + share * self.path[low + 1])

    def radiance(self, t_us: NDArray[np.int64] | Floats) -> Singles:
        """(times, height, width) in DN."""
        return np.asarray(paint(self.poses(t_us), self.canvas))

    def lit(self, factor: float) -> "Scene":
        """The same, with so many times the light."""
        canvas = self.canvas
        card = np.where(canvas.card >= 0, factor * canvas.card, canvas.card).astype(np.float32)
        shading, discs = (factor * canvas.shading).astype(np.float32), factor * canvas.disc_dn
        return replace(self, canvas=canvas._replace(shading=shading, card=card, disc_dn=discs))


def draw_scene(rng: np.random.Generator, width: int = 48, height: int = 36, seconds: float = 12.0) -> Scene:
    """Every scene is different; it can be recorded for up to `seconds`."""
    discs = int(rng.integers(2, 4))
    canvas = Canvas(
        texture=_texture(rng),
        shading=_shading(rng, width, height),
        card=_cards(rng, width, height),
        disc_dn=np.exp(rng.uniform(np.log(15), np.log(220), discs)),
        disc_radius=rng.uniform(2.5, 6.0, discs),
    )
    path, speed = _path(rng, width, height, discs, seconds)
    return Scene(width, height, seconds, canvas, path, speed)


def still_scene(dn: NDArray[Any], seconds: float = 12.0) -> Scene:
    """Nothing moves: (height, width) radiance in DN, for closed forms, lens caps and noise rates."""
    blank, none = np.ones((2, 2), np.float32), np.zeros(0)
    canvas = Canvas(blank, np.ones(dn.shape, np.float32), dn.astype(np.float32), none, none)
    times = int((seconds * 1e6 + 2 * LEAD_US) / GRID_US) + 1
    return Scene(dn.shape[1], dn.shape[0], seconds, canvas, np.zeros((times, 4)), np.zeros(times))


def _texture(rng: np.random.Generator) -> Singles:
    """Periodic smooth noise with structure from 3 to 20 pixels, in log radiance, s.d. about .3, bounded."""
    frequency = FINENESS * np.hypot(np.fft.fftfreq(TEXTURE)[:, None], np.fft.rfftfreq(TEXTURE))  # 1/px
    finest = rng.uniform(3.0, 5.0)  # pixels
    amplitude = np.exp(-0.5 * (frequency * 2 * np.pi * finest / 4) ** 2)
    amplitude /= (0.05 + frequency) ** rng.uniform(0.6, 1.4)
    amplitude[0, 0] = 0
    noise = np.fft.irfft2(np.fft.rfft2(rng.standard_normal((TEXTURE, TEXTURE))) * amplitude)
    noise *= rng.uniform(0.3, 0.45) / noise.std()
    return np.exp(0.5 * np.tanh(noise / 0.5)).astype(np.float32)


def _shading(rng: np.random.Generator, width: int, height: int) -> Singles:
    """Static, smooth, over nearly the whole range of brightness."""
    y, x = np.mgrid[0:height, 0:width]
    tilt, phase = rng.uniform(0, 2 * np.pi, (2, 3))
    waves = sum(
        np.sin(2 * np.pi * (k + 1) * (x / width * np.cos(a) + y / height * np.sin(a)) * 0.6 + p)
        for k, (a, p) in enumerate(zip(tilt, phase, strict=True))
    )
    rank = np.argsort(np.argsort(np.asarray(waves).ravel())).reshape(height, width) / (width * height - 1)
    return np.asarray(np.exp(np.log(18) + rank * (np.log(135) - np.log(18))), np.float32)


def _cards(rng: np.random.Generator, width: int, height: int) -> Singles:
    """About two fifths of the array behind static cards of 6x6 pixels, their brightness spread evenly."""
    rows, columns = max(height // 12, 1), max(width // 12, 1)
    chosen = rng.permutation(rows * columns)[: max(round(0.4 * rows * columns), 1)]
    brightness = rng.permutation(np.linspace(DARKEST, BRIGHTEST, 4 * len(chosen)))
    card = np.full((height, width), -1, np.float32)
    for n, cell in enumerate(chosen):
        top, left = 12 * (cell // columns), 12 * (cell % columns)
        for k, (dy, dx) in enumerate(((0, 0), (0, 6), (6, 0), (6, 6))):
            card[top + dy : top + dy + 6, left + dx : left + dx + 6] = brightness[4 * n + k]
    return card


def _pace(rng: np.random.Generator, steps: int) -> tuple[Floats, Floats]:
    """Speed of the plane in px/s at each step of the grid, and the phase each belongs to."""
    speed, phase = np.zeros(steps), np.zeros(steps)
    at, order = 0, rng.permutation(3)  # one order for all: no pace stays away for more than .36 s
    for count in range(steps):
        pace = (0.0, rng.uniform(4, 12), rng.uniform(50, 160))[order[count % 3]]
        length = int(rng.uniform(100_000, 180_000) / GRID_US)
        speed[at : at + length], phase[at : at + length] = pace, count
        at += length
        if at >= steps:
            break
    ramp = np.hanning(20_000 // GRID_US)  # no infinite acceleration
    return np.asarray(np.convolve(speed, ramp / ramp.sum(), "same"), float), phase


def _path(
    rng: np.random.Generator, width: int, height: int, discs: int, seconds: float
) -> tuple[Floats, Floats]:
    steps = int((seconds * 1e6 + 2 * LEAD_US) / GRID_US) + 1
    speed, phase = _pace(rng, steps)
    step = speed * GRID_US * 1e-6
    per_phase = int(phase[-1]) + 1
    heading = rng.uniform(0, 2 * np.pi, per_phase)[phase.astype(int)]
    turning = rng.uniform(-0.025, 0.025, per_phase)[phase.astype(int)]  # radians per pixel slid
    angle = rng.uniform(0, 2 * np.pi) + np.cumsum(step * turning)
    start = rng.uniform(0, TEXTURE / FINENESS, 2)
    columns = [
        start[0] + np.cumsum(step * np.cos(heading)),
        start[1] + np.cumsum(step * np.sin(heading)),
        np.cos(angle),
        np.sin(angle),
    ]
    travelled = np.cumsum(step)
    for _ in range(discs):
        direction, lead = rng.uniform(0, 2 * np.pi), rng.uniform(0, 200, 2)
        shares = np.cos(direction), np.sin(direction)
        for extent, share, ahead in zip((width, height), shares, lead, strict=True):
            columns.append(np.abs((ahead + 1.3 * share * travelled) % (2 * extent) - extent))  # bounces
    return np.column_stack(columns), speed
