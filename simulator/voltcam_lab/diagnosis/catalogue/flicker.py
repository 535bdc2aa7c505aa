"""A lamp: its frequency and phase from the events, and the form in which a diagnosis looks for it."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters
from voltcam_simulator.effect import Events

from .candidate import Candidate, Interval, interval_about, within_limits
from .clues import Clues
from .entry import SceneSimulator


@dataclass(frozen=True)
class Lamp(Candidate):
    """Flicker. The first size is its depth. turns_per_log times the logarithm of the second is added to the
    phase."""

    turns_per_log: float = 0.25
    """Turns of a lamp for a logarithm of 1 of the second size. Convention: a step of 0.15 is 14 degrees."""

    def on(self, parameters: Parameters, size: tuple[float, ...]) -> Parameters:
        """The parameters with flicker of a depth and phase."""
        turns = self.others["phase_turns"] + self.turns_per_log * math.log(size[1])
        there = {**self.others, "depth": size[0], "phase_turns": turns - round(turns)}
        return within_limits(parameters, {self.effect: there})

    def intervals(
        self, parameters: Parameters, log_half_widths: tuple[float, ...], origin_us: int = 0
    ) -> dict[str, Interval]:
        """Of the depth, and of the phase on the recording's clock."""
        lamp = parameters.flicker
        turns, half = (
            later_turns(lamp.phase_turns, lamp.frequency_hz, -origin_us),
            self.turns_per_log * log_half_widths[1],
        )
        depth = interval_about(lamp.depth, log_half_widths[0])
        return {"depth": depth, "phase_turns": (turns, turns - half, turns + half)}


def lamp_on_clock(parameters: Parameters, t_us: int) -> dict[str, Any]:
    """The phase at t_us."""
    lamp = parameters.flicker
    return {"phase_turns": later_turns(lamp.phase_turns, lamp.frequency_hz, t_us)} if lamp.active else {}


def later_turns(turns: float, frequency_hz: float, t_us: int) -> float:
    """The phase at t_us of what has `turns` at zero, -0.5 to 0.5."""
    period_us = 1e6 / frequency_hz
    return math.remainder(turns + math.fmod(t_us, period_us) / period_us, 1.0)


def spectral_line(t_us: NDArray[np.int64], on: NDArray[np.bool_], hz: float) -> complex:
    """Sum over events of +-1 (ON, OFF) times exp(-2 pi i hz t)."""
    return complex(np.where(on, 1.0, -1.0) @ np.exp(-2j * np.pi * hz * 1e-6 * t_us))


@dataclass(frozen=True)
class LampSearch:
    """How a lamp is looked for: part of its catalogue entry. Sources are as in `search/settings.py`."""

    sizes: tuple[tuple[float, ...], ...] = ((0.02, 1.0), (0.05, 1.0))
    """Depth [share of the light], and nothing added to the phase. Convention."""
    band_hz: tuple[float, float] = (40.0, 500.0)
    """Frequencies that are looked at: mains lamps and their doubles, up to what DLP and dimmers have."""
    mains_hz: float = 100.0
    """Taken where no lamp is found: of light on 50 Hz mains."""
    step_us: int = 500
    """Time in which events are counted together. Convention: a quarter of the shortest period."""
    least_line: float = 8.0
    """A line this loud is a lamp [root of the number of events]. Development: without a lamp the loudest has
    2 to 5, with a depth of 1 % it has 50."""
    depths: tuple[float, ...] = (0.002, 0.02, 0.05, 0.15)
    """Depths [share of the light] that are simulated to find a lamp's phase. Convention."""

    def candidates(self, clues: Clues) -> tuple[Candidate, ...]:
        """A lamp of the loudest frequency, at phase 0."""
        others = {"frequency_hz": self.loudest_hz(clues.t_us, clues.events["p"]), "phase_turns": 0.0}
        return (Lamp("flicker", ("depth", "advance"), self.sizes, others),)

    def loudest_hz(self, t_us: NDArray[np.int64], on: NDArray[np.bool_]) -> float:
        """The frequency in band_hz at which ON and OFF events alternate most; t_us ascending.

        ON and OFF counted alike would show twice the frequency of a lamp: its light rises once a period, and
        falls once. It is mains_hz where no line is louder than those of chance. Those are often near the
        upper end, and to simulate light that flickers so fast costs ten times as much.
        """
        if t_us.size < 2:
            return self.mains_hz
        step = (t_us - t_us[0]) // self.step_us
        signed, rate = np.bincount(step, 2.0 * on - 1), np.bincount(step).astype(float)
        window = np.ones(81) / 81
        slow, level = (np.convolve(each, window, mode="same") for each in (signed, rate))
        power = np.abs(np.fft.rfft((signed - slow) / np.sqrt(level + 1), n=4 * rate.size)) ** 2
        hz = np.fft.rfftfreq(4 * rate.size, self.step_us * 1e-6)
        inside = (hz >= self.band_hz[0]) & (hz <= self.band_hz[1])
        if not inside.any():
            return self.mains_hz
        near = hz[inside][np.argmax(power[inside])] + np.linspace(-1, 1, 41) * hz[1]
        loudness, loudest = max((abs(spectral_line(t_us, on, one)), one) for one in near.tolist())
        return loudest if loudness >= self.least_line * np.sqrt(t_us.size) else self.mains_hz

    def in_step(
        self, rig: SceneSimulator, parameters: Parameters, lamp: Candidate, events: Events
    ) -> Candidate:
        """The lamp with the phase at which the simulated events alternate as the recording's (EVENT) do.

        Frames at a fraction of the lamp's frequency leave the same part of each frame undisturbed, so the
        phase must be right. How late events come depends on the depth: the phase is taken at the depth that
        gives as loud a line. Without a lamp nothing is simulated.
        """

        def line(run: Events) -> complex:
            trusted = rig.in_trusted_light(run)
            return spectral_line(trusted["t"], trusted["p"], lamp.others["frequency_hz"])

        def made(depth: float) -> complex:
            return complex(
                np.mean([line(run) for run in rig.events(lamp.on(parameters, (depth, 1.0)), range(4))])
            )

        measured = line(events)
        if abs(measured) < self.least_line * np.sqrt(events.size):
            return lamp
        depth = np.interp(abs(measured), [abs(made(depth)) for depth in self.depths], self.depths)
        turns = np.angle(measured * np.conj(made(float(depth)))) / (2 * np.pi)
        return replace(lamp, others={**lamp.others, "phase_turns": float(turns)})
