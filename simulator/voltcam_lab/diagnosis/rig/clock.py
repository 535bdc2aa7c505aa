"""The clock of a recording: a diagnosis counts time from near its beginning, a camera file from zero."""

from voltcam_simulator import Parameters

from ...recordings import Footage
from ..catalogue.entries import ENTRIES

_TICKS_US = 4_032_000  # a multiple of all ticks a camera may have: stamps stay as divisible as they are


def origin_us(footage: Footage) -> int:
    """Where the diagnosis' clock begins, on the recording's."""
    return int(footage.frame_t_us[0]) // _TICKS_US * _TICKS_US


def counted_from(parameters: Parameters, t_us: int) -> Parameters:
    """The same camera on a clock whose zero is at t_us: of what has a clock of its own, the phase."""
    changes = {entry.effect: moved for entry in ENTRIES if (moved := entry.on_clock(parameters, t_us))}
    clock = parameters.residual_clock  # no entry of the catalogue
    if clock.active:
        begin_ns, period_ns = round(1000 * clock.begin_us), round(1000 * clock.period_us)  # as it counts them
        changes["residual_clock"] = {"begin_us": (begin_ns - 1000 * t_us) % period_ns / 1000}
    return parameters.changed(changes) if changes else parameters
