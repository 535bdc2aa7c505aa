"""H: how long after a change of brightness its events come, by brightness."""

from itertools import pairwise
from typing import Any

import numpy as np

from voltcam_lab.statistics.group import Group, Values, labels
from voltcam_lab.statistics.setting import PARTS, Setting
from voltcam_lab.statistics.strata import INTENSITIES, INTENSITY_NAMES
from voltcam_lab.statistics.stream import EventTable
from voltcam_simulator.kernel import kernel

EDGES_US = (-2000, 0, 200, 500, 1000, 2000, 5000, 12_000, 40_000)
LAGS = len(EDGES_US) - 1
_NAMES = tuple(f"{a / 1000:g} to {b / 1000:g} ms" for a, b in pairwise(EDGES_US))
_LABELS = labels(
    "H", "change before events", "value", ("intensity", INTENSITY_NAMES), ("lag", _NAMES), floor=0.2
)


def observe_lag_response(setting: Setting, stream: EventTable) -> Values:
    """Sum over events of +-1 times the change of ln(L + k2) in a span of time before it: ON +, OFF -."""
    stream = stream.settled
    table = np.zeros((PARTS, INTENSITIES, LAGS))
    add_changes(
        stream.t_us, stream.place, stream.on, stream.part, stream.intensity, setting.scene.t_us,
        1 / np.diff(setting.scene.t_us), setting.log_light, np.array(EDGES_US), table,
    )  # fmt: skip
    return table.reshape(PARTS, INTENSITIES * LAGS)


@kernel
def add_changes(
    t_us: Any, place: Any, on: Any, part: Any, intensity: Any, scene_us: Any, per_us: Any, log_light: Any,
    edges_us: Any, table: Any,
) -> None:  # fmt: skip
    """Add to the table (parts, intensities, lags). Beyond its ends the scene stands still; per_us: 1/span."""
    step = np.zeros(edges_us.size, np.int64)  # the one that each lag is in; events ascend in time
    for i in range(t_us.size):
        total = table[part[i], intensity[i]]
        later = np.float32(0)
        for k in range(edges_us.size):
            t, s = t_us[i] - edges_us[k], step[k]
            while s + 2 < scene_us.size and t > scene_us[s + 1]:
                s += 1
            step[k] = s
            share = (t - scene_us[s]) * per_us[s]
            before, after = log_light[s, place[i]], log_light[s + 1, place[i]]
            level = before + min(max(share, 0.0), 1.0) * (after - before)
            if k > 0:
                total[k - 1] += later - level if on[i] else level - later
            later = level


LAG_RESPONSE = Group("H", _LABELS, observe_lag_response)
