"""Group F: when in the frame's period events come.

Bounds are 4.5 standard deviations or more wide: another seed would fail once in 100 000 times.
"""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_lab.statistics import Setting
from voltcam_lab.statistics.frame_phase import PHASES, ROW_BANDS, crowding, frame_phase_of
from voltcam_lab.statistics.stream import stream_of

from .streams import HEIGHT, PERIOD_US, WIDTH, poisson, seen, settled, still, stream

SECONDS = 8.0


@pytest.fixture(scope="module")
def rest() -> Setting:
    return still(SECONDS)


def test_phase_in_frame(rest: Setting) -> None:
    rng = np.random.default_rng(7)
    events = settled(poisson(rng, 5.0))
    locked = events.copy()
    locked["t"] = locked["t"] // PERIOD_US * PERIOD_US + 3010 + rng.integers(0, 20, len(events))
    assert seen(rest, locked, "F", "events", "ON", "rest", "2/8")[0] == len(events)
    free, tight = (seen(rest, e, "F", "crowding in phase", "ON", "rest")[0] for e in (events, locked))
    assert free == pytest.approx(4, abs=4 * 4.5 * np.sqrt(2 * 256) / (len(events) / 4))
    assert tight > 4 * 250


def test_crowding_is_one_by_chance_and_the_number_of_bins_where_all_come_at_once() -> None:
    even = np.random.default_rng(19).multinomial(20_000, np.full(64, 1 / 64), 200).astype(float)
    assert crowding(even).mean() == pytest.approx(1, abs=0.01)  # less 60 / 20 000; sd .0001 of the mean
    one = np.zeros(64)
    one[5] = 100_000
    assert crowding(one) == pytest.approx(64, rel=1e-3)


def test_the_phase_counts_from_the_begin_of_the_exposure(rest: Setting) -> None:
    """4 ms before the stamp of each frame, where that is known."""
    frame_t_us = np.arange(0, 8_000_001, PERIOD_US)
    early = replace(rest, exposure_us=np.column_stack([frame_t_us - 4000, frame_t_us - 1000]))
    t_us = np.sort(np.random.default_rng(21).integers(1, 8_000_000, 500))
    for setting, began_us in ((early, -4000), (rest, 0)):
        phase = frame_phase_of(setting, stream_of(setting, stream(t_us, 3)))
        assert phase == pytest.approx((t_us - began_us) % PERIOD_US / PERIOD_US, abs=1e-9)


def test_rows_that_are_read_in_turn_stand_in_their_bands(rest: Setting) -> None:
    """A row scan over the frame's period: bands of rows follow one another through the phases."""
    row = np.repeat(np.arange(HEIGHT), 5)
    t_us = 60 * PERIOD_US + 1 + (row + 0.5) / HEIGHT * PERIOD_US
    events = stream(t_us.astype(np.int64), row * WIDTH)
    for band in range(ROW_BANDS):
        mine = row[row * ROW_BANDS // HEIGHT == band]
        wanted = np.bincount(((mine + 0.5) / HEIGHT * PHASES).astype(int), minlength=PHASES)
        assert seen(rest, events, "F", "events", f"{band + 1}/{ROW_BANDS}").tolist() == wanted.tolist()
