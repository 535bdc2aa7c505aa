"""Events that the camera's own frames make: when exposures begin and end, and the forms looked for."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters
from voltcam_simulator.effect import Events

from ...statistics import Setting
from .candidate import Candidate
from .clues import Clues


@dataclass(frozen=True)
class ReadoutSearch:
    """How the frame readout is looked for: part of its catalogue entry. Sources are as in
    `search/settings.py`."""

    row_us: float = 35.25
    """Time between rows, where a recording does not tell it. Measured: of a DAVIS346."""
    exposure_us: float = 500.0
    """Length of an exposure, where events do not tell it. Measured: in the DAVIS346 recording that the effect
    is from."""
    shortest_us: float = 50.0
    """An exposure of which events tell is longer. Convention: below, two crowds are one."""
    lead_in_frames: int = 60
    """Frames before a recording. By then the readout has fired all pixels that it can fire at once."""

    def candidates(self, clues: Clues) -> tuple[Candidate, ...]:
        """With the exposure; with the scan of the rows; or with both and a line that is up for longer."""
        row_us = self.row_us if clues.row_us is None else clues.row_us
        start_us, exposure_us = self.exposure_of(clues.setting, clues.events, row_us)
        start_us -= clues.delay_us
        scan = {
            "frame_period_us": clues.setting.frame_period_us,
            "exposure_us": exposure_us,
            "row_us": row_us,
            "offset_us": start_us - clues.setting.scene.height * row_us,
        }
        effect = "aps_coupling"
        long_line = ("exposure_kick", "readout_kick", "line_us")
        return (
            Candidate(effect, ("exposure_kick",), ((0.03,), (-0.03,)), scan),
            Candidate(effect, ("readout_kick", "reset_kick"), ((0.03, 0.03), (-0.03, -0.03)), scan),
            Candidate(effect, long_line, ((0.03, -0.03, 300), (-0.03, 0.03, 300)), scan),
        )

    def lead_in_us(self, parameters: Parameters) -> int:
        """How long the frame readout must run before a recording."""
        readout = parameters.aps_coupling
        return round(self.lead_in_frames * readout.frame_period_us) if readout.active else 0

    def exposure_of(self, setting: Setting, events: Events, row_us: float) -> tuple[float, float]:
        """(start of some exposure [us], its length [us]): as recorded, or as events tell.

        ON events crowd in the frame's phase at the start, OFF events at the end: at once or row after row,
        whichever crowd is sharper.
        """
        if setting.exposure_us is not None:
            lengths = setting.exposure_us[:, 1] - setting.exposure_us[:, 0]
            return float(setting.exposure_us[0, 0]), float(np.median(lengths))
        period_us, origin_us = setting.frame_period_us, float(setting.frame_t_us[0])
        since_us, on = events["t"] - origin_us, events["p"]
        start, _ = _crowd(since_us[on], period_us)
        off_us, row = since_us[~on], events["y"][~on]
        end, _ = max(
            (_crowd(off_us - per_row_us * row, period_us) for per_row_us in (0.0, row_us)),
            key=lambda one: one[1],
        )
        length = (end - start) % 1.0 * period_us
        return (
            origin_us + start * period_us,
            length if self.shortest_us < length < period_us / 2 else self.exposure_us,
        )


def readout_on_clock(parameters: Parameters, t_us: int) -> dict[str, Any]:
    """The start of a frame, counted from t_us."""
    readout = parameters.aps_coupling
    if not readout.active:
        return {}
    period_ns, offset_ns = (round(1000 * us) for us in (readout.frame_period_us, readout.offset_us))
    return {"offset_us": (offset_ns - 1000 * t_us) % period_ns / 1000}


def _crowd(t_us: NDArray[np.float64], period_us: float) -> tuple[float, int]:
    """The phase (0 to 1) of a period at which most events come, and how many come within 0.1 ms of it."""
    bins = max(8, int(period_us / 100))
    phase = (t_us % period_us) / period_us
    counts = np.bincount((phase * bins).astype(np.int64), minlength=bins)
    fullest = (int(np.argmax(counts)) + 0.5) / bins
    beside = (phase - fullest + 0.5) % 1.0 - 0.5
    near = beside[np.abs(beside) < 1 / bins]
    return fullest + (float(np.median(near)) if near.size else 0.0), int(counts.max())
