"""What a calibration gives: the camera, what was found of it and on what that rests, and its file."""

from dataclasses import dataclass
from typing import Any, Literal

import yaml

from voltcam_simulator import Camera
from voltcam_simulator.camera_file import INTERVALS

from ..health import Health
from ..windows import Mask
from .calibrate import Calibration
from .estimates import Estimate
from .reading import Reading
from .refine.refinement import Refined

Method = Literal["exact", "paper"]
EXACT = ("frame_period_us", "offset_us")


@dataclass(frozen=True, eq=False)
class Calibrated:
    """camera: the result. reading: what of the recording was looked at, all its pixels; mask: times left out.
    notes: what a person should know, a line each.

    By the exact method also: estimates, what was fitted, with intervals that have the camera's values in
    them; refined, what was then moved for the camera to behave as the recording, None where nothing was;
    moved: these, as (effect.parameter, by likelihood, now).
    """

    camera: Camera
    method: Method
    health: Health
    reading: Reading
    mask: Mask
    notes: tuple[str, ...]
    estimates: tuple[Estimate, ...] = ()
    calibration: Calibration | None = None
    refined: Refined | None = None
    moved: tuple[tuple[str, float, float], ...] = ()

    def to_yaml(self, source: str) -> str:
        """The camera file, with what it rests on at its top. source: name of the recording."""
        lines = [f"# Calibrated by `voltcam calibrate` ({self.method} law) from {source}."]
        lines += [f"# {note}" for note in self.notes]
        content: dict[str, Any] = self.camera.model_dump(exclude={"parameters"})
        content |= _rounded(self.camera.parameters.model_dump(exclude_defaults=True))
        lines.append(yaml.safe_dump(content, sort_keys=False).rstrip())
        if self.estimates:
            lines += [
                "# 90 % intervals by likelihood, widened to what a parameter was moved to; and what fixes",
                "# each, data or only the prior (nothing much):",
                f"{INTERVALS}:",
            ]
        for one in self.estimates:
            interval = f"  {one.effect}.{one.parameter}: [{one.low:.3g}, {one.high:.3g}]"
            lines.append(f"{interval:<60}# {one.rests_on}")
        return "\n".join([*lines, ""])


def _rounded(value: Any) -> Any:
    """Floats to four digits, in nested mappings; times of frames as they are, since their errors add up."""
    if isinstance(value, dict):
        return {key: one if key in EXACT else _rounded(one) for key, one in value.items()}
    return float(f"{value:.4g}") if isinstance(value, float) else value
