"""Unequal thresholds, as a diagnosis looks for them."""

from dataclasses import dataclass

from voltcam_simulator import Parameters

from ...models.exact import IN_THRESHOLDS, K1_TO_K6
from .candidate import Candidate, Interval, interval_about, within_limits


@dataclass(frozen=True)
class ThresholdRatio(Candidate):
    """theta_on / theta_off is the size. Their product stays.

    Gain, leaks and noise go with theta_on, so ON events stay as they are. Events at rest fix theta_on over
    the leak so sharply that one cannot be moved without the other.
    """

    def on(self, parameters: Parameters, size: tuple[float, ...]) -> Parameters:
        """The parameters with theta_on/theta_off times the size."""
        now, up = parameters.comparator, size[0] ** 0.5
        changes = {"comparator": {"theta_on": now.theta_on * up, "theta_off": now.theta_off / up}}
        for effect, name in (K1_TO_K6[number] for number in IN_THRESHOLDS):
            changes[effect] = {name: getattr(getattr(parameters, effect), name) * up}
        return within_limits(parameters, changes)

    def is_on(self, parameters: Parameters) -> bool:
        """Never: the size multiplies the ratio that a camera file has."""
        return False

    def intervals(
        self, parameters: Parameters, log_half_widths: tuple[float, ...], origin_us: int = 0
    ) -> dict[str, Interval]:
        """Each threshold has half of the ratio's logarithm."""
        half = log_half_widths[0] / 2
        names = ("theta_on", "theta_off")
        return {name: interval_about(getattr(parameters.comparator, name), half) for name in names}
