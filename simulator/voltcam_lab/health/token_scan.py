"""Whether events run over the rows, round after round, as with a token: from stamps and rows alone.

In windows of a millisecond, the coherence |mean exp(2 pi i (row/rows - t/round))| at the best of many times
of a round: 1 where every event waits for the token, next to nothing where rows come as they like.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_closing, binary_opening

from voltcam_simulator.effect import Events
from voltcam_simulator.effects.arbiter_scan import SLOT_US
from voltcam_simulator.kernel import kernel

from .token_load import begins_with_load, burst_loads, burst_that_ends, rows_together

WINDOW_US = SLOT_US
ROUNDS_US = (100.0, 700.0)  # a window has more than one round
STEP_HZ = 60.0  # a sixteenth of a turn over a window
FEWEST = 60  # events of a window: at 160 times of a round, a coherence of .5 comes by chance once in 20 000
COHERENT = 0.5
MOST = 120  # events of a window that are looked at
FEWEST_WINDOWS = 5
SHORTEST = 3  # windows: shorter is a burst that the bus reads row by row
MOST_WINDOWS = 6000


@dataclass(frozen=True)
class TokenScan:
    """round_us: time of a round, in the middle of all windows with one. share: of the windows with events
    enough, those in which the token goes round. episode_us: mean length of a stretch of such windows. The
    others are parameters of `arbiter_scan`."""

    round_us: float
    share: float
    episode_us: float
    rows_together: int
    busy_per_us: float
    steepness: float
    burst_per_us: float

    def in_words(self) -> str:
        """For a report."""
        begins = f", the more often the higher the load (its power of {self.steepness:.1f})"
        return (
            f"in {self.share:.0%} of the time a token goes round the rows, {self.rows_together} at once, once"
            f" in {self.round_us:.0f} us, in stretches of {self.episode_us / 1000:.0f} ms"
            f"{begins if self.busy_per_us > 0 else ''}"
        )


@dataclass(frozen=True, eq=False)
class Windows:
    """Of WINDOW_US each: edges_us (N + 1,), counts of events (N,), coherence at the best frequency (N,), that
    frequency [Hz] (N,)."""

    edges_us: NDArray[np.int64]
    counts: NDArray[np.int64]
    coherence: NDArray[np.float64]
    frequency_hz: NDArray[np.float64]

    @classmethod
    def of(cls, events: Events, height: int) -> "Windows":
        """The first MOST_WINDOWS of a stream that is not empty."""
        t_us = np.ascontiguousarray(events["t"], np.int64)
        first, last = int(t_us[0]) // WINDOW_US, int(t_us[-1]) // WINDOW_US
        edges_us = WINDOW_US * np.arange(first, min(max(last, first + 1), first + MOST_WINDOWS) + 1)
        edges = np.searchsorted(t_us, edges_us)
        frequencies = np.arange(1e6 / ROUNDS_US[1], 1e6 / ROUNDS_US[0], STEP_HZ)
        coherence, best = coherences(t_us, np.ascontiguousarray(events["y"]), edges, frequencies, height)
        return cls(edges_us, np.diff(edges), coherence, frequencies[best])


def find_token_scan(events: Events, height: int) -> TokenScan | None:
    """None where too few windows have enough events, or rows do not take turns."""
    if len(events) < FEWEST:
        return None
    windows = Windows.of(events, height)
    t_us, edges_us, counts = np.ascontiguousarray(events["t"], np.int64), windows.edges_us, windows.counts
    judged = counts >= FEWEST
    going = np.asarray(binary_opening(judged & (windows.coherence > COHERENT), np.ones(SHORTEST)), np.bool_)
    if np.count_nonzero(going) < FEWEST_WINDOWS:
        return None
    round_us = float(1e6 / np.median(windows.frequency_hz[going]))
    share = float(going.sum() / judged.sum())
    going = np.logical_or(going, binary_closing(going, np.ones(SHORTEST)))
    changes = np.diff(going.astype(np.int8), prepend=0, append=0)
    stretches = edges_us[np.stack([np.flatnonzero(changes > 0), np.flatnonzero(changes < 0)], axis=1)]
    loads = burst_loads(t_us)
    burst_per_us = burst_that_ends(t_us, loads, stretches)
    bursts = np.isin(edges_us[:-1], t_us[loads > burst_per_us] // WINDOW_US * WINDOW_US)
    busy_per_us, steepness = begins_with_load(counts, going, bursts)
    return TokenScan(
        round_us,
        share,
        float(np.diff(stretches).mean()),
        rows_together(events, stretches, round_us),
        busy_per_us,
        steepness,
        burst_per_us,
    )


@kernel
def coherences(t_us: Any, row: Any, edges: Any, frequencies: Any, height: Any) -> Any:
    """(windows,) coherence at the best frequency, and which that is. edges (windows + 1,): of the events."""
    windows = edges.shape[0] - 1
    coherence, best = np.zeros(windows), np.zeros(windows, np.int64)
    for w in range(windows):
        first, last = edges[w], edges[w + 1]
        if last - first < FEWEST:
            continue
        every = 1 + (last - first) // MOST
        count = (last - first + every - 1) // every
        for k in range(frequencies.shape[0]):
            real = imaginary = 0.0
            for i in range(first, last, every):
                turn = row[i] / height - frequencies[k] * 1e-6 * (t_us[i] - t_us[first])
                real += np.cos(2 * np.pi * turn)
                imaginary += np.sin(2 * np.pi * turn)
            size = np.hypot(real, imaginary) / count
            if size > coherence[w]:
                coherence[w], best[w] = size, k
    return coherence, best
