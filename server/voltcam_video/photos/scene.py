"""A scene from photographs."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_video.photos.light import Light, light_of
from voltcam_video.photos.motion import Matrix, PlaneMotion, displaced
from voltcam_video.photos.plane import FINENESS, Plane, background, cutout

LAYERS = 4
SPEED_PX_S = 100.0
REACH_BACKGROUND, REACH_CUTOUT = 0.15, 0.35
NEARER = 0.6, 1.6  # how fast a cut-out moves, relative to `speed_px_s`

_Part = tuple[slice, slice]


class PhotoScene:
    """Planes with photographs on them, moving under smooth random homographies; the nearer hide the farther.

    photographs: any sequence of what `light_of` takes; only those drawn are looked at, again where there are
    fewer than layers. width, height: of a frame. layers: planes, the background among them, from 1.
    speed_px_s: r.m.s. speed of the background's middle. seed: the same gives the same scene.
    crop: (left, top, width, height), the part of the frame that is drawn; None: all.

    Every answer is a pure function of time. Light is what falls on a pixel at that moment: no exposure time
    blurs it. Raises ValueError.

    Scenes of this kind train networks that reconstruct images from events: Rebecq et al., CVPR 2019, and
    Stoffregen et al., ECCV 2020.
    """

    def __init__(
        self,
        photographs: Sequence[NDArray[Any]],
        width: int,
        height: int,
        *,
        layers: int = LAYERS,
        speed_px_s: float = SPEED_PX_S,
        seed: int = 0,
        crop: tuple[int, int, int, int] | None = None,
    ) -> None:
        if not len(photographs):
            raise ValueError("a scene needs a photograph, and there is none")
        if width < 2 or height < 2:
            raise ValueError(f"a frame has at least 2 x 2 pixels, not {width} x {height}")
        if not 1 <= layers <= 255:
            raise ValueError(f"a scene has 1 to 255 layers, not {layers}")
        if not (speed_px_s > 0 and np.isfinite(speed_px_s)):
            raise ValueError(f"a speed is above 0 pixels per second, not {speed_px_s}")
        left, top, *size = crop or (0, 0, width, height)
        if not (0 <= left < left + size[0] <= width and 0 <= top < top + size[1] <= height):
            raise ValueError(f"a crop of {crop} is not within a frame of {width} x {height}")
        self.width, self.height, self.layers = *size, layers
        self._to_crop = np.array([[1.0, 0.0, -left], [0.0, 1.0, -top], [0.0, 0.0, 1.0]])
        rng = np.random.default_rng(seed)
        turns = -(-layers // len(photographs))
        which = np.concatenate([rng.permutation(len(photographs)) for _ in range(turns)])[:layers].tolist()
        self._planes: list[Plane] = []
        self._motions: list[PlaneMotion] = []
        for layer, (index, own) in enumerate(zip(which, rng.spawn(layers), strict=True)):
            light = light_of(photographs[index])
            near = own.uniform(*NEARER) if layer else 1.0
            reach = REACH_CUTOUT if layer else REACH_BACKGROUND
            self._motions.append(PlaneMotion(width, height, own, speed_px_s=near * speed_px_s, reach=reach))
            self._planes.append(
                cutout(light, width, height, own) if layer else background(light, width, height)
            )

    def frame(self, t_us: float) -> Light:
        """Light at `t_us`, (H, W) float32 in 0..255 DN."""
        image = np.empty((self.height, self.width), np.float32)
        for _, part, light, cover in self._seen(t_us):
            image[part] = light if cover is None else image[part] * (1 - cover) + light
        return image

    def order(self, t_us: float) -> NDArray[np.uint8]:
        """Which layer a pixel shows, (H, W): 0 is the background, higher ones are nearer.

        Of a soft edge, where two are seen through each other: the one that covers at least half.
        """
        order = np.zeros((self.height, self.width), np.uint8)
        for layer, part, _, cover in self._seen(t_us):
            if cover is not None:
                order[part][cover >= 0.5] = layer
        return order

    def flow(self, t_us: float) -> NDArray[np.float32]:
        """Velocity of what a pixel shows, (H, W, 2) float32: x and y [pixels/s]; exact."""
        order = self.order(t_us)
        flow = np.empty((self.height, self.width, 2), np.float32)
        for layer in range(self.layers):
            y, x = np.nonzero(order == layer)
            matrix, change = (self._to_crop @ each for each in self._motions[layer].at(t_us))
            rate = change @ np.linalg.inv(
                matrix
            )  # of a point (x, y, 1) of the frame that goes with the plane
            dx, dy, depth = rate @ np.array([x, y, np.ones(x.size)])
            flow[y, x, 0], flow[y, x, 1] = dx - x * depth, dy - y * depth
        return flow

    def homographies(self, t_us: float) -> Matrix:
        """From each plane to the frame, (layers, 3, 3) float64.

        What a pixel (x, y) of layer n shows at t0 is at `displaced(x, y, H1[n] @ inv(H0[n]))` at t1.
        """
        return np.stack([self._to_crop @ motion.at(t_us)[0] for motion in self._motions])

    def _seen(self, t_us: float) -> list[tuple[int, _Part, Light, Light | None]]:
        """From the farthest to the nearest: layer, part of the frame where it may be, its light and cover."""
        seen = []
        for layer, (plane, matrix) in enumerate(zip(self._planes, self.homographies(t_us), strict=True)):
            part = self._part(plane, matrix)
            if any(side.start >= side.stop for side in part):
                continue
            x = np.arange(self.width, dtype=np.float64)[None, part[1]]
            y = np.arange(self.height, dtype=np.float64)[part[0], None]
            seen.append((layer, part, *plane.seen(*displaced(x, y, np.linalg.inv(matrix)))))
        return seen

    def _part(self, plane: Plane, matrix: Matrix) -> _Part:
        """The rows and columns within which the frame shows the plane."""
        if plane.cover is None:
            return slice(0, self.height), slice(0, self.width)
        half_x, half_y = plane.middle
        x, y = displaced(
            np.array([-half_x, half_x, -half_x, half_x]) / FINENESS,
            np.array([-half_y, -half_y, half_y, half_y]) / FINENESS,
            matrix,
        )
        low = np.floor([y.min(), x.min()]).astype(int)
        high = np.ceil([y.max(), x.max()]).astype(int) + 1
        rows, columns = (
            slice(max(0, int(a)), max(0, min(int(b), size)))
            for a, b, size in zip(low, high, (self.height, self.width), strict=True)
        )
        return rows, columns
