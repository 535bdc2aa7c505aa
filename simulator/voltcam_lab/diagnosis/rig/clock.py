"""The clock of a recording: a diagnosis counts time from near its beginning, a camera file from zero."""

import math

from voltcam_simulator import Parameters

from ...recordings import Footage

_TICKS_US = 4_032_000  # a multiple of all ticks a camera may have: stamps stay as divisible as they are


def origin_us(footage: Footage) -> int:
    """Where the diagnosis' clock begins, on the recording's."""
    return int(footage.frame_t_us[0]) // _TICKS_US * _TICKS_US


def counted_from(parameters: Parameters, t_us: int) -> Parameters:
    """The same camera on a clock whose zero is at t_us: of a lamp and the frame readout, the phase."""
    changes = {}
    flicker, readout = parameters.flicker, parameters.aps_coupling
    if flicker.active:
        changes["flicker"] = {"phase_turns": later_turns(flicker.phase_turns, flicker.frequency_hz, t_us)}
    if readout.active:
        period_ns, offset_ns = (round(1000 * us) for us in (readout.frame_period_us, readout.offset_us))
        changes["aps_coupling"] = {"offset_us": (offset_ns - 1000 * t_us) % period_ns / 1000}
    return parameters.changed(changes) if changes else parameters


def later_turns(turns: float, frequency_hz: float, t_us: int) -> float:
    """The phase at t_us of what has `turns` at zero, -0.5 to 0.5."""
    period_us = 1e6 / frequency_hz
    return math.remainder(turns + math.fmod(t_us, period_us) / period_us, 1.0)
