"""The statistics that are taken of a recording to tell which physics is in it.

`setting_of` divides a scene into parts and strata once; `observe` takes all statistics of a stream of events
in it. The same is done with the events of a camera and with those of its simulated twins. A group of
statistics is a file here and a line in GROUPS.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voltcam_lab.statistics.first_passage import FIRST_PASSAGE
from voltcam_lab.statistics.frame_phase import FRAME_PHASE
from voltcam_lab.statistics.group import Group, Label, Values
from voltcam_lab.statistics.inter_event_times import INTERVALS
from voltcam_lab.statistics.lag_response import LAG_RESPONSE
from voltcam_lab.statistics.neighbours import NEIGHBOURS
from voltcam_lab.statistics.net_events import NET_EVENTS
from voltcam_lab.statistics.pixels import PIXELS
from voltcam_lab.statistics.rates import RATES
from voltcam_lab.statistics.readout import READOUT
from voltcam_lab.statistics.setting import PARTS, Setting, setting_of
from voltcam_lab.statistics.silence import SILENCE
from voltcam_lab.statistics.spectrum import SPECTRUM
from voltcam_lab.statistics.stream import stream_of
from voltcam_lab.statistics.trend import TREND

__all__ = [
    "COUNTS",
    "FLOORS",
    "GROUPS",
    "IN_ANY_LIGHT",
    "LABELS",
    "PARTS",
    "Group",
    "Label",
    "Observation",
    "Setting",
    "Values",
    "observe",
    "setting_of",
]

GROUPS: tuple[Group, ...] = (
    RATES,
    INTERVALS,
    PIXELS,
    READOUT,
    SPECTRUM,
    FRAME_PHASE,
    TREND,
    LAG_RESPONSE,
    NEIGHBOURS,
    FIRST_PASSAGE,
    NET_EVENTS,
    SILENCE,
)

LABELS: tuple[Label, ...] = tuple(label for group in GROUPS for label in group.labels)
"""What each entry of an observation is."""

COUNTS: NDArray[np.bool_] = np.array([label.kind == "count" for label in LABELS])
"""Which entries are counts."""

IN_ANY_LIGHT: NDArray[np.bool_] = np.array([group.in_any_light for group in GROUPS for _ in group.labels])
"""Which entries are of events in any light; all others are of those in known light."""

_TURN = 4.0  # times the floor, in a lull: where light comes to rest between two frames they tell least of it

FLOORS: NDArray[np.float64] = np.array([
    label.floor * (_TURN if ("slope", "lull") in label.strata else 1) for label in LABELS
])  # fmt: skip
"""Least spread of each entry, for counts that of 2 sqrt(n + 3/8); see Label.floor."""


@dataclass(frozen=True, eq=False)
class Observation:
    """values: (PARTS, len(LABELS)). Sums of parts are the observation of those parts together."""

    values: NDArray[np.float64]


def observe(setting: Setting, events: NDArray[np.void]) -> Observation:
    """All statistics of events (EVENT dtype, in any order) in a setting.

    Intervals belong to the part in which they end. Events outside of the scene's time, of the kept pixels or
    of known light are left out, and intervals through light that is not known. Net events and silence are of
    any light.
    """
    stream = stream_of(setting, events)
    return Observation(np.hstack([group.observe(setting, stream) for group in GROUPS]))
