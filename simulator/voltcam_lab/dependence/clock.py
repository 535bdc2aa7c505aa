"""A clock that one stream of events shows and others do not: found by frequency and slope along rows."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from voltcam_simulator.effect import Events

LONGEST_PERIOD_US, SHORTEST_PERIOD_US = 200_000, 500
BIN_US = SHORTEST_PERIOD_US // 4
LEAST_TURNS = 20  # of a clock within the time looked at
NEIGHBOURS = 31  # frequencies, beside a line, that tell what it would be without a clock
SHARPENED_BY, CELL_STEPS = 30_000, 13  # events, and steps each way, by which a line is placed in its cell
FALSE_LINES = 1e-3  # expected by chance in the whole scan

Power = NDArray[np.float64]


class RowClock(NamedTuple):
    """A period [us], and by how much each row is later than the one above [us].

    a_frame: how many periods there are from frame to frame, where it is a whole number; 0 where it is none.
    """

    period_us: float
    row_us: float
    a_frame: int = 0

    def __str__(self) -> str:
        slope = f", {self.row_us:+.3g} us a row" if abs(self.row_us) >= 0.05 else ""
        locked = f", {self.a_frame} to a frame" if self.a_frame else ""
        return f"a clock of {self.period_us / 1000:.4g} ms ({1e6 / self.period_us:.4g} Hz{slope}{locked})"

    def turn(self, events: Events) -> NDArray[np.float64]:
        """(n,) where in its period the clock is at each event, 0 to 1."""
        late_us = events["t"] - self.row_us * events["y"]
        return (late_us / self.period_us) % 1.0


def clock_of(
    real: Events, simulated: Sequence[Events], height: int, frame_us: float = 0.0
) -> RowClock | None:
    """The clock that shows best in the real events and not in the simulated ones; None: none beyond chance.

    frame_us: mean time from frame to frame, to which it may be locked; 0: there are no frames.
    Events in bins of row and time are turned into power over frequency and cycles a row, polarities apart
    and added. Without a clock, power in a line is exponential about that of its neighbours in frequency and
    of the simulated events there.
    """
    if len(real) == 0 or not simulated:
        return None
    begin_us, end_us = int(real["t"][0]), int(real["t"][-1]) + 1
    bins = int((end_us - begin_us) // BIN_US)
    frequencies = np.fft.rfftfreq(bins, BIN_US) if bins else np.zeros(0)
    lowest = max(1 / LONGEST_PERIOD_US, LEAST_TURNS / (end_us - begin_us))
    wanted = np.flatnonzero((frequencies >= lowest) & (frequencies <= 1 / SHORTEST_PERIOD_US))
    if wanted.size < NEIGHBOURS:
        return None
    chosen = slice(int(wanted[0]), int(wanted[-1]) + 1)
    power = _power(real, begin_us, bins, height, chosen)
    model = np.mean([_power(one, begin_us, bins, height, chosen) for one in simulated], axis=0)
    model *= len(real) * len(simulated) / max(sum(len(one) for one in simulated), 1)
    beside = (NEIGHBOURS * uniform_filter1d(power, NEIGHBOURS, axis=0) - power) / (NEIGHBOURS - 1)
    excess = power / np.maximum(np.maximum(beside, model), 1e-9)  # 2 exponentials, of mean 1/2 each
    line, wave = (int(k) for k in np.unravel_index(int(excess.argmax()), excess.shape))
    if 2 * float(excess[line, wave]) < _least(power.size):
        return None
    frequency, cycles_per_row = _sharper(
        real, float(frequencies[chosen][line]), float(np.fft.fftfreq(2 * height)[wave]),
        1 / (end_us - begin_us), 1 / (2 * height),
    )  # fmt: skip
    locked = _turns_a_frame(frequency, frame_us, 1 / (end_us - begin_us))
    return RowClock(1 / frequency, -cycles_per_row / frequency, locked)


def _turns_a_frame(frequency: float, frame_us: float, frequency_step: float) -> int:
    """A whole number, if a multiple of the frames' frequency is as near as frequencies can be told apart."""
    turns = round(frequency * frame_us)
    return turns if turns and abs(frequency - turns / frame_us) <= frequency_step / 2 else 0


def _sharper(
    events: Events, frequency: float, wave: float, frequency_step: float, wave_step: float
) -> tuple[float, float]:
    """A line within its cell of frequency [1/us] and wave [cycles a row]: where most turns agree."""
    own = events[:: max(1, len(events) // SHARPENED_BY)]
    t_us, y = (own[name].astype(np.float64) for name in "ty")
    sign = np.where(own["p"], 0, 1)
    parts = np.linspace(-0.6, 0.6, CELL_STEPS)
    best, top = (frequency, wave), -1.0
    along = [np.exp(-2j * np.pi * (wave + part * wave_step) * y) for part in parts]
    for part in parts:
        turns = np.exp(-2j * np.pi * (frequency + part * frequency_step) * t_us)
        for at, rows in zip(parts, along, strict=True):
            both = turns * rows
            power = sum(abs(both[sign == k].sum()) ** 2 for k in (0, 1))
            if power > top:
                best, top = (frequency + part * frequency_step, wave + at * wave_step), power
    return best


def _least(cells: int) -> float:
    """Of the sum of two exponentials of mean 1, reached FALSE_LINES times in so many: (1 + s) e^-s."""
    s = np.log(cells / FALSE_LINES)
    for _ in range(20):
        s = np.log(cells / FALSE_LINES) + np.log1p(s)
    return float(s)


def _power(events: Events, begin_us: int, bins: int, height: int, chosen: slice) -> Power:
    """(frequencies, waves along the rows) mean of both polarities, as of events that come at any time."""
    total: Power = np.zeros(0)
    for on in (False, True):
        own = events[events["p"] == on]
        at = (own["t"] - begin_us) // BIN_US
        inside = (at >= 0) & (at < bins)
        place = own["y"][inside].astype(np.int64) * bins + at[inside]
        counts = np.bincount(place, minlength=height * bins).reshape(height, bins).astype(np.float32)
        spectrum = np.fft.rfft(counts, axis=1)[:, chosen]
        waves = np.abs(np.fft.fft(spectrum, 2 * height, axis=0)) ** 2
        power = waves.T / max(len(own), 1)
        total = total + power / 2 if total.size else power / 2
    return total
