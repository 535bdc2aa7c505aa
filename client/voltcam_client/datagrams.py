"""Events in UDP datagrams, in the forms of two other projects. Words are little-endian.

================= ========================================== ================== =======================
form              an event                                   in a datagram      what it does not carry
================= ========================================== ================== =======================
t32_x16_y15_on1   u32 t [us] modulo 2^32, u16 x,             176 events at most 71.6 minutes and more
                  u16 2 y + on
spif              u32 2^31 + 2^16 x + 2^15 on + y            128 events at most times
================= ========================================== ================== =======================

The first is faery's; its reader notices when times begin again. The second is AEStream's, and that of the
SPIF boards of SpiNNaker, without time stamps. Both hold 32768 pixels a side.
"""

from collections.abc import Callable, Iterator
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import Events

DatagramForm = Literal["t32_x16_y15_on1", "spif"]
MOST_SIDE = 32768
_T32 = np.dtype([("t", "<u4"), ("x", "<u2"), ("y_on", "<u2")])


class _Form(NamedTuple):
    most_events: int
    encode: Callable[[Events], NDArray[np.generic]]


def _t32(events: Events) -> NDArray[np.generic]:
    found = np.empty(len(events), _T32)
    found["t"] = events["t"].astype(np.uint64) & 0xFFFFFFFF
    found["x"] = events["x"]
    found["y_on"] = 2 * events["y"] + events["p"]
    return found


def _spif(events: Events) -> NDArray[np.generic]:
    x, on, y = (events[name].astype("<u4") for name in ("x", "p", "y"))
    return np.asarray(1 << 31 | x << 16 | on << 15 | y)


FORMS: dict[DatagramForm, _Form] = {"t32_x16_y15_on1": _Form(176, _t32), "spif": _Form(128, _spif)}
"""176 events of 8 bytes are a datagram that no network of 1500 bytes a packet cuts."""


def datagrams(events: Events, form: DatagramForm) -> Iterator[bytes]:
    """The events in order, in as many datagrams as they need; coordinates below MOST_SIDE."""
    most, encode = FORMS[form]
    encoded = encode(events)
    for begin in range(0, len(events), most):
        yield encoded[begin : begin + most].tobytes()
