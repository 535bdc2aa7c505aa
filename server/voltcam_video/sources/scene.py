"""The built-in scene: something to see without a camera.

A pure function of time, smooth in it, and exactly periodic (PERIOD_US), so that it looks the same at any
epoch. Drawn on a plane of 346 x 260 units and stretched to the size asked for:

- everywhere, a smooth texture: twelve plane waves of 18 to 120 units that drift together by 90 units/s to the
  lower right (1.5 pixels per frame at the default size and rate);
- at the bottom, black and white bars with hard edges, moving left as fast;
- in the middle, a white disc with a hard edge, on a circle;
- at the upper right, a patch that flickers at 8 Hz;
- at the upper left, four areas that never change, one of them dark (`static_areas`): what fires there is leak
  and noise.
"""

import math
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import count

import numpy as np
from numpy.typing import NDArray

from voltcam_video.clock import Clock
from voltcam_video.frame import Frame
from voltcam_video.request import SourceRequest
from voltcam_video.sources.recorded import RecordedSource
from voltcam_video.sources.source import Granted, SourceError

WIDTH, HEIGHT, FPS = 346, 260, 60.0
MOST_PIXELS = 4096 * 4096  # drawing takes some 30 bytes of each
PERIOD_US = 20_000_000

# Texture: each wave (p, q, phase in turns) has p and q periods per TILE units; the velocity (VX, VY) makes
# every wave's frequency, p*VX/TILE + q*VY/TILE, a multiple of 1/20 Hz.
TILE, VX, VY = 360, 72, 54
MEAN_DN, WAVE_DN = 118.0, 17.0
WAVES = (
    (3, 1, 0.00), (2, -3, 0.31), (5, 4, 0.62), (7, -2, 0.13), (4, 7, 0.44), (9, 3, 0.75),
    (8, -7, 0.26), (12, 5, 0.57), (6, 11, 0.88), (14, -4, 0.09), (11, 12, 0.40), (17, 6, 0.71),
)  # fmt: skip

SINGLE_THREADED = 200_000  # multiplications that OpenBLAS does in one thread

BARS_TOP, BARS_PERIOD, BARS_SPEED = 208, 45, 90
DISC_X, DISC_Y, DISC_ORBIT, DISC_RADIUS, DISC_HZ = 173, 130, 42, 22, 0.35
FLICKER, FLICKER_HZ = (266, 20, 60, 60), 8
STATIC_X, STATIC_Y, STATIC_SIDE = 16, 16, 40
STATIC_GREYS = (12, 64, 128, 224)


@dataclass(frozen=True)
class Area:
    """A rectangle of pixels, `image[area.rows, area.columns]`, of one grey value that never changes."""

    x: int
    y: int
    width: int
    height: int
    grey: int

    @property
    def rows(self) -> slice:
        return slice(self.y, self.y + self.height)

    @property
    def columns(self) -> slice:
        return slice(self.x, self.x + self.width)


def static_areas(width: int = WIDTH, height: int = HEIGHT) -> tuple[Area, ...]:
    """The four still areas of the scene at that size, darkest first."""
    areas = []
    for i, grey in enumerate(STATIC_GREYS):
        x, y = STATIC_X + STATIC_SIDE * (i % 2), STATIC_Y + STATIC_SIDE * (i // 2)
        rows, columns = _pixels(x, y, STATIC_SIDE, STATIC_SIDE, width, height)
        areas.append(
            Area(columns.start, rows.start, columns.stop - columns.start, rows.stop - rows.start, grey)
        )
    return tuple(areas)


def render(t_us: int, width: int = WIDTH, height: int = HEIGHT) -> NDArray[np.uint8]:
    """The scene at `t_us`, (height, width) uint8. Pure: the same time gives the same image."""
    t = t_us % PERIOD_US / 1e6
    x, y, across = _axes(width, height)
    image = _texture(t, y, across)
    _bars(image, t, x, height)
    _disc(image, t, x, y)
    rows, columns = _pixels(*FLICKER, width, height)
    image[rows, columns] = 128 + 90 * math.sin(2 * math.pi * FLICKER_HZ * t)
    for area in static_areas(width, height):
        image[area.rows, area.columns] = area.grey
    rounded: NDArray[np.uint8] = np.clip(image + np.float32(0.5), 0, 255).astype(np.uint8)
    return rounded


@lru_cache(maxsize=8)
def _axes(width: int, height: int) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float32]]:
    """Pixel centres in units, along x and y, and the waves' sine and cosine along x."""
    x = np.arange(0.5, width, dtype=np.float64) * (WIDTH / width)
    y = np.arange(0.5, height, dtype=np.float64) * (HEIGHT / height)
    turns = np.array([p for p, _, _ in WAVES])[:, None] * x / TILE
    across = np.concatenate([np.sin(2 * np.pi * turns), np.cos(2 * np.pi * turns), np.ones((1, width))])
    return x, y, across.astype(np.float32)


def _texture(t: float, y: NDArray[np.float64], across: NDArray[np.float32]) -> NDArray[np.float32]:
    """The waves. Since sin(a + b) = sin a cos b + cos a sin b, their sum is one matrix product."""
    _, q, phase = np.array(WAVES).T
    hertz = np.array([p * VX + q * VY for p, q, _ in WAVES]) / TILE
    turns = y[:, None] * q / TILE + phase - hertz * t
    waves = [WAVE_DN * np.cos(2 * np.pi * turns), WAVE_DN * np.sin(2 * np.pi * turns)]
    down = np.concatenate([*waves, np.full((len(y), 1), MEAN_DN)], axis=1).astype(np.float32)
    image = np.empty((len(y), across.shape[1]), np.float32)
    # In parts too small for BLAS to share among threads, which would wait for each other on a busy machine.
    step = max(1, SINGLE_THREADED // across.size)
    for row in range(0, len(y), step):
        np.matmul(down[row : row + step], across, out=image[row : row + step])
    return image


def _bars(image: NDArray[np.float32], t: float, x: NDArray[np.float64], height: int) -> None:
    units = x[1] - x[0] if len(x) > 1 else float(WIDTH)
    in_period = (x + BARS_SPEED * t) % BARS_PERIOD
    from_edge = np.abs(in_period - BARS_PERIOD / 2) - BARS_PERIOD / 4
    image[round(BARS_TOP * height / HEIGHT) :] = 24 + 200 * np.clip(from_edge / units + 0.5, 0, 1)


def _disc(image: NDArray[np.float32], t: float, x: NDArray[np.float64], y: NDArray[np.float64]) -> None:
    angle = 2 * math.pi * DISC_HZ * t
    centre_x, centre_y = DISC_X + DISC_ORBIT * math.cos(angle), DISC_Y + DISC_ORBIT * math.sin(angle)
    columns = slice(*np.searchsorted(x, (centre_x - DISC_RADIUS - 2, centre_x + DISC_RADIUS + 2)))
    rows = slice(*np.searchsorted(y, (centre_y - DISC_RADIUS - 2, centre_y + DISC_RADIUS + 2)))
    inside = DISC_RADIUS - np.hypot(x[columns] - centre_x, y[rows, None] - centre_y)
    cover = np.clip(inside * image.shape[1] / WIDTH + 0.5, 0, 1)
    image[rows, columns] += cover * (240 - image[rows, columns])


def _pixels(x: int, y: int, w: int, h: int, width: int, height: int) -> tuple[slice, slice]:
    """Rows and columns of a rectangle given in units."""
    columns = slice(round(x * width / WIDTH), round((x + w) * width / WIDTH))
    rows = slice(round(y * height / HEIGHT), round((y + h) * height / HEIGHT))
    return rows, columns


class SceneSource(RecordedSource):
    """The scene at `width`, `height` and `fps` of the request; it does not end."""

    endless = True

    def __init__(self, request: SourceRequest, clock: Clock, stop: threading.Event) -> None:
        # It begins where it is to begin at once: drawing all before that could take for ever.
        super().__init__(request.model_copy(update={"start_s": 0.0}), clock, stop)
        self.request = request
        self._width, self._height = request.width or WIDTH, request.height or HEIGHT
        if self._width * self._height > MOST_PIXELS:
            raise SourceError(
                f"a scene of {self._width} x {self._height} is too large: give at most {MOST_PIXELS} pixels"
            )
        self._fps = request.fps or FPS
        self.granted = Granted(
            kind="scene",
            live=False,
            width=self._width,
            height=self._height,
            fps=self._fps,
            pixel_format=None,
            frames=None,
            backend=None,
            clock="recording",
            levels=self.levels,
        )

    @classmethod
    def reads(cls, request: SourceRequest) -> bool:
        return request.uri == "scene"

    def _take(self) -> Iterator[Frame]:
        for i in count(math.ceil(self.request.start_s % (PERIOD_US / 1e6) * self._fps)):
            t_us = round(i * 1e6 / self._fps)
            yield Frame(render(t_us, self._width, self._height), t_us, gamma=self.gamma)
