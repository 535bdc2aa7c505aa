"""L: pixels without an event in a half of the recording, while their neighbours have many.

Light is nearly that of the neighbours, however it went between frames: so events count in any light. That a
pixel is dead it does not share with them.
"""

import numpy as np
from numpy.typing import NDArray

from voltcam_lab.statistics.group import Group, Values, labels
from voltcam_lab.statistics.setting import PARTS, Setting
from voltcam_lab.statistics.stream import EventTable

SILENT = (3.0, 6.0, 12.0)
_AROUND = [(dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1) if (dy, dx) != (0, 0)]

_LABELS = labels("L", "silent pixels", "count", ("events of neighbours", tuple(f"{n:g}" for n in SILENT)))


def observe_silence(setting: Setting, stream: EventTable) -> Values:
    """How many pixels are silent though half of their neighbours have as many events. Parts are by halves of
    the recording."""
    tile = setting.tiles.ravel()[setting.pixels]
    table = np.zeros((PARTS, len(SILENT)))
    for half, n in enumerate(stream.in_any_light):
        busy = around(setting, n)[n == 0]
        parity = tile[n == 0]
        for k, least in enumerate(SILENT):
            table[2 * half : 2 * half + 2, k] = np.bincount(parity[busy >= least], minlength=2)
    return table


def around(setting: Setting, n: NDArray[np.int32]) -> NDArray[np.float64]:
    """(K,) the lower median over a pixel's neighbours of n, (K,); 0 where it has none.

    One hot pixel, or one that is dead, does not move it.
    """
    height, width = setting.scene.height, setting.scene.width
    image = np.full((height + 2, width + 2), np.nan)
    y, x = np.divmod(setting.pixels, width)
    image[y + 1, x + 1] = n
    near = np.sort([image[y + 1 + dy, x + 1 + dx] for dy, dx in _AROUND], axis=0)  # those not kept come last
    there = np.count_nonzero(~np.isnan(near), axis=0)
    lower = np.take_along_axis(near, np.maximum(there - 1, 0)[None] // 2, axis=0)[0]
    return np.asarray(np.nan_to_num(lower))


SILENCE = Group("L", _LABELS, observe_silence, in_any_light=True)
