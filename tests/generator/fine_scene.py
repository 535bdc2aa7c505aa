"""Scenes of a finer texture, all over the sensor: six plane waves before a ramp of light, always moving.

Nothing is at rest for long, and nothing is known of the light between frames but what these show.
"""

import numpy as np

from .kernel import FINENESS
from .pixels import Canvas
from .scene import GRID_US, LEAD_US, TEXTURE, Floats, Scene, Singles

WAVES = 6
WAVELENGTH_PX = (6.0, 26.0)
AMPLITUDE = (0.08, 0.22)  # in ln L
DARKEST, BRIGHTEST = 4.0, 126.0  # DN, at the left and at the right
FASTEST_PX_S = 200.0
TURN_US = 150_000  # from one velocity to the next
SMOOTH_US = 20_000


def draw_fine_scene(
    rng: np.random.Generator, width: int = 48, height: int = 36, seconds: float = 12.0
) -> Scene:
    """Every scene is different; it can be recorded for up to `seconds`."""
    ramp = np.exp(np.linspace(np.log(DARKEST), np.log(BRIGHTEST), width))
    shading = np.tile(ramp, (height, 1)).astype(np.float32)
    none = np.zeros(0)
    canvas = Canvas(_waves(rng), shading, np.full((height, width), -1, np.float32), none, none)
    path, speed = _wander(rng, seconds)
    return Scene(width, height, seconds, canvas, path, speed)


def _waves(rng: np.random.Generator) -> Singles:
    """Periodic: each wave fits the torus a whole number of times along both axes."""
    side = TEXTURE / FINENESS  # pixels
    y, x = np.mgrid[0:TEXTURE, 0:TEXTURE] / FINENESS
    log = np.zeros((TEXTURE, TEXTURE))
    for _ in range(WAVES):
        wavelength, way = np.exp(rng.uniform(*np.log(WAVELENGTH_PX))), rng.uniform(0, 2 * np.pi)
        times = np.round(side / wavelength * np.array([np.cos(way), np.sin(way)]))
        phase = rng.uniform(0, 2 * np.pi)
        log += rng.uniform(*AMPLITUDE) * np.sin(2 * np.pi * (times[0] * x + times[1] * y) / side + phase)
    return np.exp(log).astype(np.float32)


def _wander(rng: np.random.Generator, seconds: float) -> tuple[Floats, Floats]:
    """A velocity drawn anew every TURN_US, smoothed; the plane does not turn."""
    steps = int((seconds * 1e6 + 2 * LEAD_US) / GRID_US) + 1
    turns = steps * GRID_US // TURN_US + 1
    speed, way = rng.uniform(0, FASTEST_PX_S, turns), rng.uniform(0, 2 * np.pi, turns)
    number = np.arange(steps) * GRID_US // TURN_US
    window = np.hanning(SMOOTH_US // GRID_US + 2)
    velocity = [
        np.convolve((speed * part)[number], window / window.sum(), "same")
        for part in (np.cos(way), np.sin(way))
    ]
    shift = [np.cumsum(one) * GRID_US * 1e-6 for one in velocity]
    path = np.column_stack([*shift, np.ones(steps), np.zeros(steps)])
    return path, np.hypot(*velocity)
