"""F: when in the frame's period events come, and where in the rows' scan."""

import numpy as np

from voltcam_lab.statistics.group import MOTION, POLARITY, Group, Values, labels, tally
from voltcam_lab.statistics.setting import PARTS, Setting
from voltcam_lab.statistics.stream import EventTable

PHASES, ROW_BANDS, FINE = 8, 4, 256
_FEW = 30  # events make no crowd
_PHASE = ("phase", tuple(f"{k}/{PHASES}" for k in range(PHASES)))
_ROWS = ("rows", tuple(f"{k + 1}/{ROW_BANDS}" for k in range(ROW_BANDS)))

_LABELS = (
    *labels("F", "events", "count", MOTION, POLARITY, _PHASE),
    *labels("F", "events", "count", _ROWS, _PHASE),
    *labels("F", "crowding in phase", "value", MOTION, POLARITY, floor=0.05),
)


def observe_frame_phase(setting: Setting, stream: EventTable) -> Values:
    """What the camera's own frames do to its events stands at one phase, or runs down the rows."""
    stream = stream.settled
    phase = frame_phase_of(setting, stream)
    kind = 2 * stream.moving + stream.on
    band = stream.pixel // setting.scene.width * ROW_BANDS // setting.scene.height
    fine = tally(stream.part, kind * FINE + (phase * FINE).astype(np.int64), 4 * FINE)
    coarse = fine.reshape(PARTS, 4 * PHASES, -1).sum(axis=2)
    by_row = tally(stream.part, band * PHASES + (phase * PHASES).astype(np.int64), ROW_BANDS * PHASES)
    return np.hstack([coarse, by_row, crowding(fine.reshape(PARTS, 4, FINE))])


def frame_phase_of(setting: Setting, stream: EventTable) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """(n,) in [0, 1): time since the last frame began, in frame periods."""
    starts_us = setting.frame_starts_us
    frame = np.maximum(np.searchsorted(starts_us, stream.t_us, side="right") - 1, 0)
    phase = (stream.t_us - starts_us[frame]) / setting.frame_period_us
    return np.minimum(phase - np.floor(phase), np.nextafter(1, 0))


def crowding(n: Values) -> Values:
    """Pairs in the same of FINE bins, (..., bins), per pair and bin: 1 where the phase does not matter."""
    total = n.sum(axis=-1)
    pairs: Values = (n * (n - 1)).sum(axis=-1) * n.shape[-1] / (total + _FEW) ** 2
    return pairs


FRAME_PHASE = Group("F", _LABELS, observe_frame_phase)
