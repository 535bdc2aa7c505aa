"""Group G: how rates change over the recording.

Bounds are 4.5 standard deviations or more wide: another seed would fail once in 100 000 times.
"""

import numpy as np
import pytest

from voltcam_lab.statistics import Setting
from voltcam_lab.statistics.stream import stream_of
from voltcam_lab.statistics.trend import SLICES, slice_of

from .streams import PIXELS, brightening, poisson, seen, still, stream

SECONDS = 8.0


@pytest.fixture(scope="module")
def rest() -> Setting:
    return still(SECONDS)


def test_trend_follows_the_rate(rest: Setting) -> None:
    rng = np.random.default_rng(8)
    events = poisson(rng, 10.0)
    warming = events[rng.random(len(events)) < events["t"] / 8e6]
    n = seen(rest, warming, "G", "events at rest", "ON")
    expected = 80 * PIXELS * (2 * np.arange(6) + 1) / 72
    assert (np.abs(n - expected) < 4.5 * np.sqrt(expected)).all()


def test_slices_are_equal_and_have_first_and_last(rest: Setting) -> None:
    t_us = np.array([1, 1_333_334, 1_333_335, 4_000_000, 4_000_001, 8_000_000])
    assert slice_of(rest, stream_of(rest, stream(t_us, 0))).tolist() == [0, 0, 1, 2, 3, SLICES - 1]


def test_what_moves_has_no_trend() -> None:
    rise = brightening(2.0)
    events = poisson(np.random.default_rng(20), 5.0, 2.0)
    events = events[events["t"] > 100_000]  # what was before is not known, so it begins at rest
    assert not seen(rise, events, "G", "events at rest").any()
