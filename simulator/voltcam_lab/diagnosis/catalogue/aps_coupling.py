"""Events that the camera's own frames make: when exposures begin and end, and the forms looked for."""

from dataclasses import dataclass
from typing import Any

from voltcam_simulator import Parameters

from ...health.exposure_times import exposure_times
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
    lead_in_frames: int = 60
    """Frames before a recording. By then the readout has fired all pixels that it can fire at once."""

    def candidates(self, clues: Clues) -> tuple[Candidate, ...]:
        """With the exposure; with the scan of the rows; or with both and a line that is up for longer."""
        row_us = self.row_us if clues.row_us is None else clues.row_us
        setting = clues.setting
        start_us, told_us = exposure_times(clues.events, setting.frame_t_us, setting.exposure_us, row_us)
        exposure_us = self.exposure_us if told_us is None else told_us
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


def readout_on_clock(parameters: Parameters, t_us: int) -> dict[str, Any]:
    """The start of a frame, counted from t_us."""
    readout = parameters.aps_coupling
    if not readout.active:
        return {}
    period_ns, offset_ns = (round(1000 * us) for us in (readout.frame_period_us, readout.offset_us))
    return {"offset_us": (offset_ns - 1000 * t_us) % period_ns / 1000}
