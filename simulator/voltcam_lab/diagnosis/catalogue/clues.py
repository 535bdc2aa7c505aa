"""What the events tell of effects that have a clock of their own, before anything is fitted."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters

from ...statistics import Setting
from ..rig.rig import Rig
from .catalogue import Candidate, Clues

USUAL_ROW_US = 35.25  # DAVIS346
USUAL_EXPOSURE_US = 500.0
FLICKER_HZ = (40.0, 500.0)
MAINS_HZ = 100.0  # of light, where no lamp is to be heard
LEAST_LINE = 8.0  # of the root of the number of events: the loudest has 2 to 5 without a lamp, 50 with 1 %
DEPTHS = (0.002, 0.02, 0.05, 0.15)  # of the light, at which a lamp's phase is looked for


def clues(setting: Setting, events: NDArray[np.void], row_us: float | None = None) -> Clues:
    """Of events (EVENT) seen in a setting. row_us: time between rows of the frame readout, where known."""
    scene, t_us = setting.scene, events["t"].astype(np.int64)
    seconds = float(scene.t_us[-1] - scene.t_us[0]) * 1e-6
    per_ms = np.bincount((t_us - int(scene.t_us[0])) // 1000) if t_us.size else np.zeros(1)
    row_us = USUAL_ROW_US if row_us is None else row_us
    start_us, exposure_us = exposure_of(setting, events, row_us)
    start_us -= setting.parameters.latency.delay_us  # all events of the model come later by that
    return Clues(
        seconds=seconds,
        peak_rate_per_s=float(np.quantile(per_ms, 0.999)) * 1000,
        flicker_hz=loudest_hz(t_us, events["p"]),
        frame_period_us=setting.frame_period_us,
        exposure_us=exposure_us,
        row_us=row_us,
        rows=scene.height,
        exposure_start_us=start_us,
        quantum_us=quantum(t_us),
        pixels=scene.width * scene.height,
    )


def exposure_of(setting: Setting, events: NDArray[np.void], row_us: float) -> tuple[float, float]:
    """(start of some exposure [us], its length): as recorded, or from where ON events crowd in the frame's
    phase to where OFF events do, at once or row after row, whichever is the sharper crowd."""
    if setting.exposure_us is not None:
        lengths = setting.exposure_us[:, 1] - setting.exposure_us[:, 0]
        return float(setting.exposure_us[0, 0]), float(np.median(lengths))
    period_us, origin_us = setting.frame_period_us, float(setting.frame_t_us[0])
    since_us, on = events["t"] - origin_us, events["p"]
    start, _ = _crowd(since_us[on], period_us)
    off_us, row = since_us[~on], events["y"][~on]
    end, _ = max(
        (_crowd(off_us - per_row_us * row, period_us) for per_row_us in (0.0, row_us)), key=lambda one: one[1]
    )
    length = (end - start) % 1.0 * period_us
    return origin_us + start * period_us, length if 50 < length < period_us / 2 else USUAL_EXPOSURE_US


def _crowd(t_us: NDArray[np.float64], period_us: float) -> tuple[float, int]:
    """The phase (0 to 1) of a period about which most events come, and how many in a tenth of a
    millisecond."""
    bins = max(8, int(period_us / 100))
    phase = (t_us % period_us) / period_us
    counts = np.bincount((phase * bins).astype(np.int64), minlength=bins)
    fullest = (int(np.argmax(counts)) + 0.5) / bins
    beside = (phase - fullest + 0.5) % 1.0 - 0.5
    near = beside[np.abs(beside) < 1 / bins]
    return fullest + (float(np.median(near)) if near.size else 0.0), int(counts.max())


def loudest_hz(t_us: NDArray[np.int64], on: NDArray[np.bool_]) -> float:
    """The frequency at which ON and OFF events come most by turns, in FLICKER_HZ; t_us ascending.

    Both together would show twice the frequency of a lamp: its light rises once a period, and falls once.
    It is MAINS_HZ where no line is louder than those of chance, which are often near the upper end: to
    simulate light that flickers so fast costs ten times as much.
    """
    if t_us.size < 2:
        return MAINS_HZ
    step_us = 500
    step = (t_us - t_us[0]) // step_us
    signed, rate = np.bincount(step, 2.0 * on - 1), np.bincount(step).astype(float)
    window = np.ones(81) / 81
    slow, level = (np.convolve(each, window, mode="same") for each in (signed, rate))
    power = np.abs(np.fft.rfft((signed - slow) / np.sqrt(level + 1), n=4 * rate.size)) ** 2
    hz = np.fft.rfftfreq(4 * rate.size, step_us * 1e-6)
    inside = (hz >= FLICKER_HZ[0]) & (hz <= FLICKER_HZ[1])
    if not inside.any():
        return MAINS_HZ
    near = hz[inside][np.argmax(power[inside])] + np.linspace(-1, 1, 41) * hz[1]
    loudness, loudest = max((abs(line(t_us, on, one)), one) for one in near.tolist())
    return loudest if loudness >= LEAST_LINE * np.sqrt(t_us.size) else MAINS_HZ


def line(t_us: NDArray[np.int64], on: NDArray[np.bool_], hz: float) -> complex:
    """Sum over events of +-1 (ON, OFF) at their phase of a frequency: its length tells how much they come by
    turns, its angle when."""
    return complex(np.where(on, 1.0, -1.0) @ np.exp(-2j * np.pi * hz * 1e-6 * t_us))


def in_step(rig: Rig, parameters: Parameters, lamp: Candidate, events: NDArray[np.void]) -> Candidate:
    """Flicker with the phase at which the model's events come when those (EVENT) of the recording do: with
    frames at a fraction of the lamp's frequency it is always the same part of a frame that it disturbs.

    How late events come depends on how deep the flicker is: the phase is taken where there are as many. Where
    no lamp is to be heard there is none to find, and no time spent on it.
    """

    def seen(run: NDArray[np.void]) -> complex:
        known = rig.in_trusted_light(run)
        return line(known["t"], known["p"], lamp.others["frequency_hz"])

    def made(depth: float) -> complex:
        return complex(
            np.mean([seen(run) for run in rig.events(lamp.on(parameters, (depth, 1.0)), range(4))])
        )

    measured = seen(events)
    if abs(measured) < LEAST_LINE * np.sqrt(events.size):
        return lamp
    depth = np.interp(abs(measured), [abs(made(depth)) for depth in DEPTHS], DEPTHS)
    turns = np.angle(measured * np.conj(made(float(depth)))) / (2 * np.pi)
    return replace(lamp, others={**lamp.others, "phase_turns": float(turns)})


def quantum(t_us: NDArray[np.int64]) -> int:
    """The largest tick that all time stamps are multiples of [us]."""
    return max(1, int(np.gcd.reduce(t_us))) if t_us.size else 1
