"""A camera that warms up, as a diagnosis looks for it."""

from dataclasses import dataclass, field

from voltcam_simulator import Parameters
from voltcam_simulator.effects.temperature_drift import COLDEST_C, HOTTEST_C

from .candidate import Candidate


@dataclass(frozen=True)
class Warming(Candidate):
    """A temperature that passes the camera file's in the middle of the recording, `seconds` long.

    With the file's temperature at the start, leaks would be larger on average. But base parameters are
    fitted to the mean.
    """

    seconds: float = field(kw_only=True)

    def on(self, parameters: Parameters, size: tuple[float, ...]) -> Parameters:
        """The parameters with a warming, and the temperature from which it begins."""
        start_c = parameters.temperature_c - 0.5 * size[0] * self.seconds
        start_c = min(max(start_c, COLDEST_C), HOTTEST_C)
        return super().on(parameters, size).changed({"temperature_c": start_c})
