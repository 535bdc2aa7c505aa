"""G: how rates change over the recording."""

import numpy as np
from numpy.typing import NDArray

from voltcam_lab.statistics.group import POLARITY, Group, Values, labels, tally
from voltcam_lab.statistics.setting import Setting
from voltcam_lab.statistics.stream import EventTable

SLICES = 6
TIME = ("time", tuple(f"{k + 1}/{SLICES}" for k in range(SLICES)))
_LABELS = labels("G", "events at rest", "count", POLARITY, TIME)


def observe_trend(setting: Setting, stream: EventTable) -> Values:
    """A camera that warms up gives more and more ON at rest, and no more OFF."""
    stream = stream.settled
    index = stream.on * SLICES + slice_of(setting, stream)
    return tally(stream.part, np.where(stream.moving == 1, -1, index), len(_LABELS))


def slice_of(setting: Setting, stream: EventTable) -> NDArray[np.int64]:
    """(n,) which of SLICES equal parts of the recording's time an event is in."""
    begin_us, end_us = setting.block_edges_us[[0, -1]]
    number: NDArray[np.int64] = (stream.t_us - begin_us - 1) * SLICES // (end_us - begin_us)
    return number


TREND = Group("G", _LABELS, observe_trend)
