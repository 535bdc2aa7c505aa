"""With which load rounds begin and what ends them, against laws that are written out here."""

import numpy as np
import pytest

from voltcam_lab.health.token_load import (
    NO_BURST,
    begins_with_load,
    burst_loads,
    burst_that_ends,
    rows_together,
)
from voltcam_simulator import EVENT

RNG = np.random.default_rng(4)
STRETCHES = np.array([[10_000, 40_000], [60_000, 80_000], [95_000, 120_000]])


def stamped(t_us: np.ndarray) -> np.ndarray:
    events = np.zeros(len(t_us), EVENT)
    events["t"] = np.sort(t_us)
    return events


def test_a_law_of_the_load_is_found() -> None:
    """40 s with some 300 begins, and a burst that ends them each 40 ms: busy_per_us is known to 3 %, the
    power to 0.6, and 3 standard deviations are allowed."""
    slots = 40_000
    load = 0.28 + 0.08 * np.sin(np.arange(slots) / 500)
    counts = RNG.poisson(1000 * load)
    going, bursts = np.zeros(slots, np.bool_), np.arange(slots) % 40 == 39
    counts[bursts] += 900
    for k in range(4, slots):
        if not bursts[k - 4 : k].any():
            often = 0.1 * (counts[k - 4 : k].mean() / 1000 / 0.4) ** 9
            going[k] = going[k - 1] or RNG.random() < often
    busy_per_us, steepness = begins_with_load(counts, going, bursts)
    assert busy_per_us == pytest.approx(0.4, rel=0.09)
    assert steepness == pytest.approx(9, abs=1.8)


def test_rounds_that_are_always_there_need_no_load() -> None:
    counts = np.full(1000, 300)
    assert begins_with_load(counts, np.ones(1000, np.bool_), np.zeros(1000, np.bool_)) == (0.0, 0.0)


def test_rounds_that_end_and_do_not_begin_again_are_not_always_there() -> None:
    """Half a begin in 900 slots at 0.3 events/us."""
    counts, going = np.full(1000, 300), np.arange(1000) < 100
    busy_per_us, steepness = begins_with_load(counts, going, np.zeros(1000, np.bool_))
    assert 0.1 * (0.3 / busy_per_us) ** steepness == pytest.approx(0.5 / 900, rel=0.01)


def test_a_burst_ends_rounds_where_nothing_within_is_like_it() -> None:
    quiet = RNG.integers(0, 130_000, 40_000)
    bursts = [end + RNG.integers(-100, 100, 800) for _, end in STRETCHES.tolist()]
    for t_us, lowest, highest in (
        (np.concatenate([quiet, *bursts]), 0.5, 2.5),
        (quiet, NO_BURST, NO_BURST),
    ):
        t_us = np.sort(t_us)
        assert lowest <= burst_that_ends(t_us, burst_loads(t_us), STRETCHES) <= highest


def test_the_load_of_a_burst_is_an_exponential_mean() -> None:
    """10 events/us for long are 10; 300 us later an e-th of that is left."""
    t_us = np.append(np.repeat(np.arange(5000), 10), 5299)
    loads = burst_loads(t_us)
    assert loads[-2] == pytest.approx(10, rel=0.01)
    assert loads[-1] == pytest.approx(10 / np.e, rel=0.01)


@pytest.mark.parametrize("together", [1, 2, 5])
def test_rows_that_leave_together_are_counted(together: int) -> None:
    height, round_us = 180, 250
    events = stamped(RNG.integers(0, 130_000, 40_000))
    events["x"], events["y"] = RNG.integers(0, 240, 40_000), RNG.integers(0, height, 40_000)
    passes = events["y"].astype(np.int64) // together * together * round_us // height
    events["t"] += (passes - events["t"]) % round_us
    events = events[np.lexsort((events["y"], events["t"]))]  # a bus reads them row by row
    assert rows_together(events, STRETCHES, round_us) == together
