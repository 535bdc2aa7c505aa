"""Scenes of photographs: one turns and zooms, others fly in front of it.

The photographs are those that scikit-learn and Matplotlib bring with them.
"""

from functools import cache
from pathlib import Path

import matplotlib
import numpy as np
import sklearn.datasets
from PIL import Image
from scipy.ndimage import gaussian_filter, zoom

from .kernel import FINENESS
from .pixels import Canvas
from .scene import GRID_US, LEAD_US, TEXTURE, Floats, Scene, Singles

PHOTOGRAPHS = (
    Path(sklearn.datasets.__file__).parent / "images" / "china.jpg",
    Path(sklearn.datasets.__file__).parent / "images" / "flower.jpg",
    Path(matplotlib.get_data_path()) / "sample_data" / "grace_hopper.jpg",
)
GAMMA = 2.2  # from light to the grey levels of a photograph
DARKEST, BRIGHTEST = 4.0, 230.0  # DN
LENS_PX = 0.5  # sd of its blur [pixels of the sensor]
SIDE_PX = TEXTURE // FINENESS // 2  # of a piece, at a zoom of 1
COARSENESS = 3  # pixels of a photograph along one of the sensor
FLYING, RADIUS_PX = 3, (4.0, 9.0)
TURN_US, SMOOTH_US = 150_000, 30_000  # from one motion to the next
FASTEST_PX_S, FASTEST_TURN, FASTEST_ZOOM = 120.0, 1.5, 0.8  # pixels, radians, logarithms a second
WIDEST_ZOOM = 0.4  # logarithm, either way


def draw_photo_scene(
    rng: np.random.Generator, width: int = 48, height: int = 36, seconds: float = 12.0
) -> Scene:
    """Every scene is different; it can be recorded for up to `seconds`."""
    canvas = Canvas(
        texture=_plane(rng),
        shading=np.ones((height, width), np.float32),
        card=np.full((height, width), -1, np.float32),
        disc_dn=np.ones(FLYING),
        disc_radius=rng.uniform(*RADIUS_PX, FLYING),
        disc_print=np.stack([_plane(rng) for _ in range(FLYING)]),
    )
    path, speed = _path(rng, width, height, seconds)
    return Scene(width, height, seconds, canvas, path, speed)


@cache
def _light_of(photograph: Path) -> Floats:
    """(height, width), of 0 to 1."""
    grey = np.asarray(Image.open(photograph).convert("L"), float) / 255
    return np.asarray(grey**GAMMA)


def _plane(rng: np.random.Generator) -> Singles:
    """A piece of a photograph [DN], mirrored at its edges, so that it is periodic."""
    light = _light_of(PHOTOGRAPHS[int(rng.integers(len(PHOTOGRAPHS)))])
    side = SIDE_PX * COARSENESS
    top, left = (int(rng.integers(0, size - side)) for size in light.shape)
    piece = zoom(light[top : top + side, left : left + side], TEXTURE / 2 / side, order=1)
    piece = np.block([[piece, piece[:, ::-1]], [piece[::-1], piece[::-1, ::-1]]])
    piece = gaussian_filter(piece, LENS_PX * FINENESS, mode="wrap")
    low, high = np.percentile(piece, (1, 99))
    share = np.clip((piece - low) / (high - low), 0, 1)
    share = np.roll(share, rng.integers(0, TEXTURE, 2), (0, 1))  # what mirrors is not in the middle of a disc
    return np.asarray(DARKEST + share * (BRIGHTEST - DARKEST), np.float32)


def _path(rng: np.random.Generator, width: int, height: int, seconds: float) -> tuple[Floats, Floats]:
    steps = int((seconds * 1e6 + 2 * LEAD_US) / GRID_US) + 1

    def moved(*velocities: Floats) -> list[Floats]:
        return [np.cumsum(one) * GRID_US * 1e-6 for one in velocities]

    x, y = _velocity(rng, steps)
    turn, growth = (_wandering(rng, steps, fastest) for fastest in (FASTEST_TURN, FASTEST_ZOOM))
    angle, larger = moved(turn, growth)
    size = np.exp(WIDEST_ZOOM * np.sin(larger / WIDEST_ZOOM))
    path = [*moved(x, y), size * np.cos(angle), size * np.sin(angle)]
    for _ in range(FLYING):
        for extent, way in zip((width, height), moved(*_velocity(rng, steps)), strict=True):
            path.append(np.abs((rng.uniform(0, 2 * extent) + way) % (2 * extent) - extent))  # bounces
    return np.column_stack(path), np.hypot(x, y)


def _velocity(rng: np.random.Generator, steps: int) -> tuple[Floats, Floats]:
    """px/s along both axes."""
    speed = np.abs(_wandering(rng, steps, FASTEST_PX_S))
    way = _wandering(rng, steps, np.pi)
    return speed * np.cos(way), speed * np.sin(way)


def _wandering(rng: np.random.Generator, steps: int, most: float) -> Floats:
    """From -most to most, drawn anew every TURN_US, smoothed."""
    values = rng.uniform(-most, most, steps * GRID_US // TURN_US + 1)
    window = np.hanning(SMOOTH_US // GRID_US + 2)
    by_step = values[np.arange(steps) * GRID_US // TURN_US]
    return np.asarray(np.convolve(by_step, window / window.sum(), "same"))
