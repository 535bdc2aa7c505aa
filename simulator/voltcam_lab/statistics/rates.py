"""A: how many events, by polarity, brightness, and change of brightness."""

from voltcam_lab.statistics.group import POLARITY, Group, Values, labels, tally
from voltcam_lab.statistics.setting import Setting
from voltcam_lab.statistics.strata import INTENSITIES, INTENSITY_NAMES, SLOPE_NAMES, SLOPES
from voltcam_lab.statistics.stream import EventTable

_LABELS = labels("A", "events", "count", POLARITY, ("intensity", INTENSITY_NAMES), ("slope", SLOPE_NAMES))


def observe_rates(setting: Setting, stream: EventTable) -> Values:
    """Gain, thresholds, leak and noise by where they are; a lag shows as events in a lull."""
    stream = stream.settled
    return tally(
        stream.part, (stream.on * INTENSITIES + stream.intensity) * SLOPES + stream.slope, len(_LABELS)
    )


RATES = Group("A", _LABELS, observe_rates)
