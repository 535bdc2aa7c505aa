"""Events on the device: keys in space that grows, and columns of sorted ones."""

from typing import Any, NamedTuple

import numpy as np

from ..effect import EVENT, Events
from ..event_key import unpack
from . import arrays
from .arrays import DeviceArray
from .target import cuda, launched


class DeviceEvents(NamedTuple):
    """Events sorted by time, in arrays on the device (n,), each with `__cuda_array_interface__`."""

    t: DeviceArray
    """int64 [us]."""
    x: DeviceArray
    """uint16 [pixels]."""
    y: DeviceArray
    """uint16 [pixels]."""
    p: DeviceArray
    """bool: True is ON."""

    def to_host(self) -> Events:
        """The same as an array of dtype EVENT."""
        events = np.empty(self.t.size, EVENT)
        for name, column in zip(self._fields, self, strict=True):
            events[name] = arrays.download(column)
        return events


def events_of(keys: DeviceArray, start_us: int) -> DeviceEvents:
    """Sorted keys of an interval that starts at start_us, as events."""
    events = DeviceEvents(*(arrays.empty(keys.size, EVENT[name]) for name in DeviceEvents._fields))
    arrays.launch(_unpack, keys.size, events, (keys,), np.int64(start_us))
    return events


def left_there(events: Events | DeviceEvents | None) -> DeviceEvents:
    """Events of an interval on the device, wherever they were; None: there are none."""
    if isinstance(events, DeviceEvents):
        return events
    host = np.empty(0, EVENT) if events is None else events
    return DeviceEvents(*(arrays.upload(host[name]) for name in DeviceEvents._fields))


@launched
def _unpack(events: Any, keys: Any, start_us: Any) -> None:
    i = cuda.grid(1)
    if i < keys[0].shape[0]:
        one = slice(i, i + 1)
        unpack(keys[0][one], start_us, events.t[one], events.x[one], events.y[one], events.p[one])
