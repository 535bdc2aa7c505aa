"""Scenes and streams made by hand, and a way to read an observation by names."""

import numpy as np
from numpy.typing import NDArray

from voltcam_client.packet import EVENT
from voltcam_lab.light.known import SETTLED_US
from voltcam_lab.light.scene import scene_of
from voltcam_lab.statistics import GROUPS, Setting, setting_of
from voltcam_lab.statistics.stream import stream_of

WIDTH, HEIGHT, PERIOD_US = 24, 18, 10_000
PIXELS = WIDTH * HEIGHT

Events = NDArray[np.void]
Times = NDArray[np.int64]


def still(seconds: float = 8.0, grey: float = 100.0, **more: object) -> Setting:
    """Nothing moves: every pixel is at rest. 100 frames a second from time 0."""
    t_us = np.arange(0, int(seconds * 1e6) + 1, PERIOD_US)
    return setting_of(
        scene_of(np.full((len(t_us), HEIGHT, WIDTH), grey, np.float32), t_us, "linear"), t_us, **more
    )


def brightening(seconds: float = 2.0, per_s: float = 1.15) -> Setting:
    """ln(L + 20) of every pixel rises by per_s a second, from L = 5."""
    t_us = np.arange(0, int(seconds * 1e6) + 1, PERIOD_US)
    grey = 25 * np.exp(per_s * t_us * 1e-6) - 20
    images = np.broadcast_to(grey[:, None, None], (len(t_us), HEIGHT, WIDTH)).astype(np.float32)
    return setting_of(scene_of(images, t_us, "linear"), t_us)


def stream(t_us: object, pixel: object, on: object = True) -> Events:
    """Events from columns, in the order given."""
    t, where, p = np.broadcast_arrays(t_us, pixel, on)
    events = np.empty(t.size, EVENT)
    events["t"], events["p"] = t.ravel(), p.ravel()
    events["y"], events["x"] = np.divmod(where.ravel(), WIDTH)
    return events


def poisson(rng: np.random.Generator, rate_hz: object, seconds: float = 8.0, on: bool = True) -> Events:
    """Events at random, rate_hz for each pixel or for all."""
    pixel = np.repeat(np.arange(PIXELS), rng.poisson(np.broadcast_to(rate_hz, PIXELS) * seconds))
    return stream(rng.integers(1, int(seconds * 1e6), len(pixel)), pixel, on)


def settled(events: Events) -> Events:
    """Those that come so late that what was before the recording does not matter."""
    return events[events["t"] >= SETTLED_US]


def seen(setting: Setting, events: Events, group: str, name: str, *strata: str) -> NDArray[np.float64]:
    """Entries of a group, summed over the parts, whose label has these classes among its strata."""
    (observed,) = (each for each in GROUPS if each.letter == group)
    values = observed.observe(setting, stream_of(setting, events)).sum(axis=0)
    return np.array([
        value
        for value, label in zip(values, observed.labels, strict=True)
        if label.name == name and set(strata) <= {which for _, which in label.strata}
    ])  # fmt: skip
