"""Group L: pixels that are silent while their neighbours are not."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import generic_filter

from voltcam_lab.light.known import KnownLight
from voltcam_lab.statistics import Setting
from voltcam_lab.statistics.silence import SILENCE, SILENT, around
from voltcam_lab.statistics.stream import stream_of

from .streams import HEIGHT, PIXELS, WIDTH, Events, poisson, seen, still

DEAD = [77, 111, 112, 300]
HALF_US = 4_000_000


@pytest.fixture(scope="module")
def rest() -> Setting:
    return still(8.0)


def recorded(rate_hz: object, seed: int = 3) -> Events:
    return poisson(np.random.default_rng(seed), rate_hz)


def silent(setting: Setting, events: Events, least: str) -> float:
    return float(seen(setting, events, "L", "silent pixels", least)[0])


def test_dead_pixels_are_counted_in_each_half(rest: Setting) -> None:
    """24 events a half of each other pixel: that one has none by chance is e^-24."""
    rate_hz = np.full(PIXELS, 6.0)
    rate_hz[DEAD] = 0
    assert silent(rest, recorded(rate_hz), "12") == 2 * len(DEAD)
    events = recorded(6.0)
    stops = np.isin(events["y"].astype(int) * WIDTH + events["x"], DEAD) & (events["t"] > HALF_US)
    assert silent(rest, events[~stops], "12") == len(DEAD)


def test_quiet_pixels_among_quiet_ones_are_not_silent(rest: Setting) -> None:
    rate_hz = np.full((HEIGHT, WIDTH), 10.0)
    rate_hz[:, :12] = 0
    rate_hz[5, 5] = 1000  # one hot pixel makes no neighbours silent
    events = recorded(rate_hz.ravel())
    assert [silent(rest, events, f"{least:g}") for least in SILENT] == [0, 0, 0]
    none = SILENCE.observe(rest, stream_of(rest, events[:0]))
    assert not none.any()


def test_events_count_in_light_that_is_not_known(rest: Setting) -> None:
    rate_hz = np.full(PIXELS, 6.0)
    rate_hz[DEAD] = 0
    unknown = replace(rest, known=KnownLight(np.zeros_like(rest.known.gaps), rest.known.taken_us, WIDTH))
    events = recorded(rate_hz)
    assert silent(unknown, events, "12") == 2 * len(DEAD)
    outside = events.copy()
    outside["t"] += 8_000_000
    assert not SILENCE.observe(rest, stream_of(rest, outside)).any()


def test_the_middle_of_the_neighbours_as_another_library_finds_it(rest: Setting) -> None:
    n = np.random.default_rng(5).integers(0, 30, PIXELS).astype(np.int32)

    def middle(near: np.ndarray) -> float:
        there = np.sort(near[near >= 0])
        return float(there[(len(there) - 1) // 2])

    ring = np.ones((3, 3), bool)
    ring[1, 1] = False
    wanted = generic_filter(
        n.reshape(HEIGHT, WIDTH).astype(float), middle, footprint=ring, mode="constant", cval=-1
    )
    np.testing.assert_array_equal(around(rest, n), wanted.ravel())


def test_a_pixel_without_neighbours_is_not_silent() -> None:
    keep = np.zeros((HEIGHT, WIDTH), bool)
    keep[4, 4] = keep[9, 9] = True
    setting = still(keep=keep)
    assert around(setting, np.array([50, 0], np.int32)).tolist() == [0, 0]
