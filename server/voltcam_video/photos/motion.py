"""How a plane moves: homographies smooth in time, with their derivatives."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]

WAVES = 3
RATES = 0.6, 1.4  # of the waves, relative to the plane's own
TURN_RAD, ZOOM, TILT = 0.25, 0.15, 0.05  # r.m.s.; zoom: of its logarithm; tilt: of depth at the frame's edge


@dataclass(frozen=True)
class Wave:
    """A sum of sines with unit variance: `amplitudes` (3,), `rates` (3,) relative, `phases` (3,) rad."""

    amplitudes: NDArray[np.float64]
    rates: NDArray[np.float64]
    phases: NDArray[np.float64]

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> "Wave":
        amplitudes = rng.uniform(0.5, 1.0, WAVES)
        return cls(
            amplitudes * math.sqrt(2.0 / float(amplitudes @ amplitudes)),
            rng.uniform(*RATES, WAVES),
            rng.uniform(0.0, 2.0 * math.pi, WAVES),
        )

    @property
    def rate(self) -> float:
        """r.m.s. of its derivative with respect to `angle`."""
        return float(np.sqrt(np.sum((self.amplitudes * self.rates) ** 2) / 2.0))

    def at(self, angle: float) -> tuple[float, float]:
        """Its value, and its derivative with respect to `angle`."""
        turned = self.rates * angle + self.phases
        return float(self.amplitudes @ np.sin(turned)), float((self.amplitudes * self.rates) @ np.cos(turned))


class PlaneMotion:
    """A plane that turns, zooms, tilts and passes through a frame; a pure function of time.

    Coordinates on the plane are pixels from its middle; in the frame, pixel centres are whole numbers. Each
    of six quantities is a sum of three sines. The r.m.s. speed of the plane's middle is `speed_px_s`, and the
    r.m.s. of its way from the frame's middle is `reach` times width and height.
    """

    def __init__(
        self, width: int, height: int, rng: np.random.Generator, *, speed_px_s: float, reach: float
    ) -> None:
        self._middle = (width - 1) / 2, (height - 1) / 2
        self._reach = reach * width, reach * height
        self._edge = max(width, height) / 2
        self._x, self._y, self._turn, self._zoom, self._tilt_x, self._tilt_y = (
            Wave.drawn(rng) for _ in range(6)
        )
        way = math.hypot(self._reach[0] * self._x.rate, self._reach[1] * self._y.rate)
        self._rad_per_us = speed_px_s / way * 1e-6

    def at(self, t_us: float) -> tuple[Matrix, Matrix]:
        """H(t) from plane to frame, (3, 3), and dH/dt [1/s]."""
        angle = self._rad_per_us * t_us
        (x, dx), (y, dy), (turn, d_turn), (zoom, d_zoom), (a, da), (b, db) = (
            wave.at(angle) for wave in (self._x, self._y, self._turn, self._zoom, self._tilt_x, self._tilt_y)
        )
        move = np.eye(3)
        move[:2, 2] = self._middle[0] + self._reach[0] * x, self._middle[1] + self._reach[1] * y
        d_move = np.zeros((3, 3))
        d_move[:2, 2] = self._reach[0] * dx, self._reach[1] * dy

        size, c, s = math.exp(ZOOM * zoom), math.cos(TURN_RAD * turn), math.sin(TURN_RAD * turn)
        spin = np.array([[size * c, -size * s, 0.0], [size * s, size * c, 0.0], [0.0, 0.0, 1.0]])
        grow = ZOOM * d_zoom * np.eye(2) + TURN_RAD * d_turn * np.array([[0.0, -1.0], [1.0, 0.0]])
        d_spin = np.zeros((3, 3))
        d_spin[:2, :2] = grow @ spin[:2, :2]

        tilt, d_tilt = np.eye(3), np.zeros((3, 3))
        tilt[2, :2] = TILT * a / self._edge, TILT * b / self._edge
        d_tilt[2, :2] = TILT * da / self._edge, TILT * db / self._edge

        change = d_move @ spin @ tilt + move @ d_spin @ tilt + move @ spin @ d_tilt
        return move @ spin @ tilt, change * (self._rad_per_us * 1e6)


def displaced(x: NDArray[np.float64], y: NDArray[np.float64], matrix: Matrix) -> tuple[Matrix, Matrix]:
    """Where a homography takes points: their x and y, of the shape that `x` and `y` broadcast to."""
    depth = matrix[2, 0] * x + matrix[2, 1] * y + matrix[2, 2]
    return (
        (matrix[0, 0] * x + matrix[0, 1] * y + matrix[0, 2]) / depth,
        (matrix[1, 0] * x + matrix[1, 1] * y + matrix[1, 2]) / depth,
    )
