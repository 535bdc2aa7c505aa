"""Arrays that networks take, made of the events of a window. Events: dtype EVENT, in any order."""

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator.effect import Events

Array = NDArray[np.float32]


def voxel_grid(events: Events, width: int, height: int, start_us: int, end_us: int, bins: int = 5) -> Array:
    """Polarities in `bins` slices of time, each shared between its two nearest slices, (bins, H, W).

    V(b) is the sum of `p max(0, 1 - |b - (bins - 1) (t - start) / (end - start)|)`, p = 1 for ON, -1 for OFF
    (Zhu, Yuan, Chaney, Daniilidis, CVPR 2019, equation 1; there start and end are the first and last event).
    """
    grid = np.zeros((bins, height * width), np.float32)
    if not len(events):
        return grid.reshape(bins, height, width)
    pixel = events["y"].astype(np.int64) * width + events["x"]
    sign = np.where(events["p"], 1.0, -1.0)
    place = (bins - 1) * (events["t"] - start_us) / (end_us - start_us)
    lower = np.clip(np.floor(place).astype(np.int64), 0, max(bins - 2, 0))
    upper_share = place - lower if bins > 1 else np.zeros(len(events))
    for slot, share in ((lower, 1 - upper_share), (lower + 1, upper_share)):
        inside = slot < bins
        flat = np.bincount(
            slot[inside] * grid.shape[1] + pixel[inside], (sign * share)[inside], minlength=grid.size
        )
        grid += flat.reshape(grid.shape).astype(np.float32)
    return grid.reshape(bins, height, width)


def event_frame(events: Events, width: int, height: int) -> Array:
    """How many events each pixel gave, ON and OFF apart, (2, H, W).

    Maqueda, Loquercio, Gallego, Garcia, Scaramuzza, CVPR 2018.
    """
    place = (
        (~events["p"]).astype(np.int64) * width * height + events["y"].astype(np.int64) * width + events["x"]
    )
    return np.bincount(place, minlength=2 * width * height).astype(np.float32).reshape(2, height, width)


def time_surface(events: Events, width: int, height: int, end_us: int, tau_us: float = 30_000.0) -> Array:
    """How new each pixel's last event is: exp(-age / tau), 0 for none; ON and OFF apart, (2, H, W).

    Lagorce, Orchard, Galluppi, Shi, Benosman, TPAMI 2017, equation 3.
    """
    last = np.full(2 * height * width, -np.inf)
    place = (
        (~events["p"]).astype(np.int64) * width * height + events["y"].astype(np.int64) * width + events["x"]
    )
    np.maximum.at(last, place, events["t"].astype(np.float64))
    return np.exp((last - end_us) / tau_us).astype(np.float32).reshape(2, height, width)
