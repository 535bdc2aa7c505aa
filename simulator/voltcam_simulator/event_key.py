"""An event packed into 64 bits, so that sorting the numbers sorts the events by time.

37 bits microseconds since the frame before (38 hours), 13 bits y, 13 bits x, 1 bit polarity.
"""

from typing import Any

import numpy as np

from .kernel import kernel

TIME_BITS, AXIS_BITS = 37, 13
_TIME_SHIFT, _Y_SHIFT, _X_SHIFT = np.uint64(27), np.uint64(14), np.uint64(1)
_AXIS_MASK, _ONE = np.uint64(0x1FFF), np.uint64(1)


@kernel
def event_address(pixel: Any, width: Any, per_width: Any) -> Any:
    """The pixel's coordinates at their place in an event key; per_width is 1 / width."""
    y = np.int64((pixel + 0.5) * per_width)  # exact, and faster than dividing integers
    return (np.uint64(y) << _Y_SHIFT) | (np.uint64(pixel - y * width) << _X_SHIFT)


@kernel
def event_key(time: Any, address: Any, side: Any) -> Any:
    """One event in 64 bits; time [us] since the frame before, rounded down to a microsecond."""
    return (np.uint64(time) << _TIME_SHIFT) | address | (_ONE if side > 0 else np.uint64(0))


def key_bits(span_us: int) -> int:
    """How many of the low bits may differ from key to key in an interval of span_us."""
    return int(_TIME_SHIFT) + (span_us + 1).bit_length()


@kernel
def unpack(keys: Any, start_us: Any, t: Any, x: Any, y: Any, p: Any) -> None:
    """Sorted event keys to the columns of an event array."""
    for i in range(keys.shape[0]):
        key = keys[i]
        t[i] = start_us + np.int64(key >> _TIME_SHIFT)
        y[i] = (key >> _Y_SHIFT) & _AXIS_MASK
        x[i] = (key >> _X_SHIFT) & _AXIS_MASK
        p[i] = (key & _ONE) != 0


@kernel
def unpack_events(keys: Any, start_us: Any, events: Any) -> None:
    """Sorted event keys to an event array: one kernel for any number of events."""
    unpack(keys, start_us, events.t, events.x, events.y, events.p)
