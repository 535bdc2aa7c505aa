"""What of a recording depends on its scene, not on its events: parts, strata, each pixel's path."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_lab.light.known import KnownLight
from voltcam_lab.light.scene import Scene
from voltcam_lab.statistics.halves import Halves, halves_of
from voltcam_lab.statistics.strata import INTENSITIES, SLOPES, LightStrata, light_strata
from voltcam_simulator import Parameters
from voltcam_simulator.kernel import kernel

PARTS = 4
"""(even, odd) time blocks x (even, odd) tiles: 0 is for training, 3 is held out."""

_BLOCK_US = 250_000  # long against the interval of two events of an edge, short against the recording
_BLOCKS = 16  # at least, where the frames allow
_BLOCK_PERIODS = 4  # and not shorter than so many frames
_TILE = 6  # pixels, and not more than 1/8 of the shorter side otherwise


@dataclass(frozen=True, eq=False)
class Setting:
    """A scene divided into parts and strata. N instants of the scene, K kept pixels, H x W pixels in all."""

    scene: Scene
    frame_t_us: NDArray[np.int64]
    frame_period_us: float
    exposure_us: NDArray[np.int64] | None
    """(frames, 2) begin and end of each frame's exposure, where known."""
    parameters: Parameters
    """The law that intervals are held against (group J), and k2. Any will do that is near: twins share it."""
    block_edges_us: NDArray[np.int64]
    """Time blocks; a block's number modulo 2 is its parity, and modulo 4 its half of the part."""
    tiles: NDArray[np.uint8]
    """(H, W) parity: a checkerboard of squares."""
    pixels: NDArray[np.int32]
    """(K,) numbers y W + x of the kept pixels, ascending."""
    place: NDArray[np.int32]
    """(H W,) where in `pixels` a pixel is, or -1."""
    log_light: NDArray[np.float32]
    """(N, K) ln(L + k2): events ascend in time, so what belongs to a time is together."""
    known: KnownLight
    """Where light is known well enough to say when an event is due."""
    strata: LightStrata
    seconds: NDArray[np.float64]
    """(PARTS, INTENSITIES, SLOPES) pixel-seconds spent in each stratum; here, and below, in known light."""
    path: NDArray[np.float64]
    """(4 blocks modulo 4, 3, K): rise and fall of ln(L + k2) while moving, and time at rest [s]."""
    bustle: NDArray[np.float64]
    """(2 tiles, N): all rises and falls of ln(L + k2) up to an instant, summed over the tiles' pixels."""
    halves: Halves
    """Of its time, in any light."""

    @property
    def frame_starts_us(self) -> NDArray[np.int64]:
        """From where the phase in a frame counts: begin of exposure, else its stamp."""
        return self.frame_t_us if self.exposure_us is None else np.ascontiguousarray(self.exposure_us[:, 0])


def setting_of(
    scene: Scene,
    frame_t_us: NDArray[np.int64],
    keep: NDArray[np.bool_] | None = None,
    exposure_us: NDArray[np.int64] | None = None,
    parameters: Parameters | None = None,
    known: KnownLight | None = None,
) -> Setting:
    """Divide a scene. keep: (H, W), the pixels to look at; None: all. parameters: None: a typical DAVIS346.
    known: as in `Setting`; None: all is.

    Raises ValueError when there are fewer than two frames or no pixel is kept.
    """
    if len(frame_t_us) < 2 or len(scene.t_us) < 2:
        raise ValueError("a recording with fewer than two frames tells nothing: record for longer")
    parameters = parameters or Parameters.of("typical")
    period_us = float(np.median(np.diff(frame_t_us)))
    size = scene.height * scene.width
    pixels = np.arange(size) if keep is None else np.flatnonzero(keep)
    if not len(pixels):
        raise ValueError("no pixel is kept: give a mask with some")
    place = np.full(size, -1, np.int32)
    place[pixels] = np.arange(len(pixels))
    light = scene.images.reshape(len(scene.t_us), size)[:, pixels]
    log_light = np.log(light + np.float32(parameters.contrast_response.k2_dn))
    strata = light_strata(light, log_light, scene.t_us)
    edges_us = block_edges_us(int(frame_t_us[0]), int(scene.t_us[0]), int(scene.t_us[-1]), period_us)
    tiles = checkerboard(scene.height, scene.width)
    known = known or KnownLight.everywhere(scene.taken_us, scene.height, scene.width)
    gap = np.searchsorted(scene.taken_us, scene.t_us[:-1], side="right") - 1
    seconds, path, bustle = spent(
        log_light,
        strata.index,
        known.gaps[np.ix_(np.clip(gap, 0, len(known.gaps) - 1), pixels)],
        scene.t_us,
        edges_us,
        np.ascontiguousarray(tiles.ravel()[pixels]),
        INTENSITIES * SLOPES,
        SLOPES,
    )
    return Setting(
        scene, frame_t_us, period_us, exposure_us, parameters, edges_us, tiles,
        pixels.astype(np.int32), place, log_light, known, strata,
        seconds.reshape(PARTS, INTENSITIES, SLOPES), path, np.cumsum(bustle, axis=1),
        halves_of(light, log_light, scene.t_us),
    )  # fmt: skip


def block_edges_us(first_frame_us: int, begin_us: int, end_us: int, period_us: float) -> NDArray[np.int64]:
    """Edges on whole frame periods, so that every block has every phase; the first and last may be cut."""
    wanted_us = min(_BLOCK_US, (end_us - begin_us) / _BLOCKS)
    block_us = max(_BLOCK_PERIODS, round(wanted_us / period_us)) * period_us
    inner = first_frame_us + np.arange(1, np.ceil((end_us - first_frame_us) / block_us)) * block_us
    inner = np.round(inner[(inner > begin_us) & (inner < end_us)]).astype(np.int64)
    return np.concatenate([[begin_us], inner, [end_us]])


def checkerboard(height: int, width: int) -> NDArray[np.uint8]:
    """(height, width) parity of square tiles."""
    side = max(_TILE, min(height, width) // 8)
    y, x = np.indices((height, width)) // side
    return ((x + y) % 2).astype(np.uint8)


@kernel
def spent(
    log_light: Any, index: Any, known: Any, t_us: Any, edges_us: Any, tile: Any, strata: Any, slopes: Any
) -> Any:
    """Pixel-seconds (parts, strata); what each pixel went through (4, 3, K); all change in a step (2, N).

    Rest is the last of the slopes. Steps of pixels whose light is not known do not count.
    """
    steps, pixels = index.shape
    seconds = np.zeros((4, strata))
    path = np.zeros((4, 3, pixels))
    bustle = np.zeros((2, steps + 1))
    block = 0
    for s in range(steps):
        while block + 2 < edges_us.size and t_us[s] + t_us[s + 1] > 2 * edges_us[block + 1]:
            block += 1
        span = (t_us[s + 1] - t_us[s]) * 1e-6
        for k in range(pixels):
            if not known[s, k]:
                continue
            change = log_light[s + 1, k] - log_light[s, k]
            stratum = index[s, k]
            bustle[tile[k], s + 1] += abs(change)
            seconds[2 * (block % 2) + tile[k], stratum] += span
            if stratum % slopes == slopes - 1:
                path[block % 4, 2, k] += span
            elif change > 0:
                path[block % 4, 0, k] += change
            else:
                path[block % 4, 1, k] -= change
    return seconds, path, bustle
