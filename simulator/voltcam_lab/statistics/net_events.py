"""K: how many more ON than OFF events a pixel has from an event in known light to a much later one.

That is what its voltage rose by: by the change of light from end to end, and by leak. Both are known however
light went between, so all events in between count, in any light. Of fast motion slow frames tell little else.
Leaks that differ from pixel to pixel show, thresholds that are not alike, and events that are lost.

Squares are of what a leak, a leak that goes with brightness, and a gain do not explain. Base parameters
move these three, and so hardly the squares.
"""

import numpy as np
from numpy.typing import NDArray

from voltcam_lab.statistics.group import Group, Values, labels
from voltcam_lab.statistics.halves import BRIGHTNESS, CHANGE
from voltcam_lab.statistics.setting import PARTS, Setting
from voltcam_lab.statistics.stream import EventTable

Pixels = NDArray[np.int64]

_FLOOR = 4.0  # a twentieth of a threshold, of some 70 pixels: what light at an event is off by on the mean
_FITS = 2  # the second one without outliers of the first
_CLIP = 8.0  # thresholds: a hot pixel must not drown the others
_CELLS = (("brightness", BRIGHTNESS), ("change of light", CHANGE))
_SIZE = len(BRIGHTNESS) * len(CHANGE)

_LABELS = (
    *labels("K", "net events", "value", *_CELLS, floor=_FLOOR),
    *labels("K", "net events squared", "value", *_CELLS, floor=_FLOOR),
)


def observe_net_events(setting: Setting, stream: EventTable) -> Values:
    """Net events beyond what the law says, and squares of what is left of them, in thresholds.

    Parts are by halves of the recording and not by every other block: the longer, the more a leak does.
    """
    tile = setting.tiles.ravel()[setting.pixels]
    table = np.zeros((PARTS, 2 * _SIZE))
    for part in range(PARTS):
        half, parity = divmod(part, 2)
        mine = np.flatnonzero((tile == parity) & (stream.ends[half, 0] >= 0))
        beyond, rest = _beyond(setting, stream, half, mine)
        weights = beyond, rest**2
        table[part] = np.hstack(
            [np.bincount(setting.halves.cell[half, mine], each, _SIZE) for each in weights]
        )
    return table


def _beyond(setting: Setting, stream: EventTable, half: int, mine: Pixels) -> tuple[Values, Values]:
    """Net events (n,) of those pixels less the rise of their voltages, and what is left of them. Of outliers
    no more than _CLIP is left in either."""
    law = setting.parameters
    first, last = stream.ends[half][:, mine]
    off, on = stream.between[half][:, mine]
    span_us = (stream.t_us[last] - stream.t_us[first]).astype(np.float64)
    dose = [setting.halves.dose_at(setting.scene.t_us, stream.t_us[end], mine) for end in (first, last)]
    photo_us = (dose[1] - dose[0]) * 1e6
    rise = (stream.log[last] - stream.log[first]).astype(np.float64)
    leaked = law.junction_leak.k4_per_us * span_us + law.parasitic_photocurrent.k5_per_dn_us * photo_us
    net = law.comparator.theta_on * on - law.comparator.theta_off * off
    beyond = net - law.contrast_response.k1 * rise - leaked
    causes = np.column_stack([span_us * 1e-6, photo_us * 1e-8, rise])
    explained, usual = np.zeros(len(mine)), np.ones(len(mine), np.bool_)
    for _ in range(_FITS):
        explained = causes @ np.linalg.lstsq(causes[usual], beyond[usual])[0]
        usual = np.abs(beyond - explained) < _CLIP
    rest = np.clip(beyond - explained, -_CLIP, _CLIP)
    return explained + rest, rest


NET_EVENTS = Group("K", _LABELS, observe_net_events, in_any_light=True)
