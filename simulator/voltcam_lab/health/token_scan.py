"""Whether events run over the rows, round after round, as with a token: from stamps and rows alone.

In windows of a millisecond, the coherence |mean exp(2 pi i (row/rows - t/round))| at the best of many times
of a round: 1 where every event waits for the token, next to nothing where rows come as they like.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from voltcam_simulator.effect import Events
from voltcam_simulator.kernel import kernel

WINDOW_US = 1000
ROUNDS_US = (100.0, 700.0)  # a window has more than one round
STEP_HZ = 60.0  # a sixteenth of a turn over a window
FEWEST = 60  # events of a window: at 160 times of a round, a coherence of .5 comes by chance once in 20 000
COHERENT = 0.5
MOST = 120  # events of a window that are looked at
FEWEST_WINDOWS = 5
MOST_WINDOWS = 6000


@dataclass(frozen=True)
class TokenScan:
    """round_us: time of a round, in the middle of all windows with one. share: of the windows with events
    enough, those in which the token goes round. episode_us: mean length of a stretch of such windows."""

    round_us: float
    share: float
    episode_us: float


def find_token_scan(events: Events, height: int) -> TokenScan | None:
    """None where too few windows have enough events, or rows do not take turns."""
    if len(events) < FEWEST:
        return None
    first, last = int(events["t"][0]), int(events["t"][-1])
    begins = first + WINDOW_US * np.arange(max((last - first) // WINDOW_US, 1), dtype=np.int64)[:MOST_WINDOWS]
    edges = np.searchsorted(events["t"], np.append(begins, begins[-1] + WINDOW_US))
    frequencies = np.arange(1e6 / ROUNDS_US[1], 1e6 / ROUNDS_US[0], STEP_HZ)
    coherence, best = coherences(
        np.ascontiguousarray(events["t"]), np.ascontiguousarray(events["y"]), edges, frequencies, height
    )
    judged = np.diff(edges) >= FEWEST
    going = judged & (coherence > COHERENT)
    beside = np.concatenate([[False], going, [False]])
    going &= beside[:-2] | beside[2:]  # a single one is a burst that the bus reads row by row
    if np.count_nonzero(going) < FEWEST_WINDOWS:
        return None
    stretches = np.count_nonzero(np.diff(going.astype(np.int8), prepend=0) > 0)
    return TokenScan(
        round_us=float(1e6 / np.median(frequencies[best[going]])),
        share=float(going.sum() / judged.sum()),
        episode_us=float(WINDOW_US * going.sum() / stretches),
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
