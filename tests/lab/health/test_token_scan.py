"""A token that goes round the rows, from stamps: its round, and how much of the time."""

import numpy as np
import pytest

from voltcam_lab.health.token_scan import find_token_scan
from voltcam_simulator import EVENT

HEIGHT, WIDTH, SECONDS = 60, 80, 2
ROUND_US = 246


def free(rate_hz: float = 200_000) -> np.ndarray:
    rng = np.random.default_rng(1)
    count = int(rate_hz * SECONDS)
    events = np.zeros(count, EVENT)
    events["t"] = np.sort(rng.integers(0, SECONDS * 1_000_000, count))
    events["x"], events["y"] = rng.integers(0, WIDTH, count), rng.integers(0, HEIGHT, count)
    return events


def scanned(events: np.ndarray, episodes: list[tuple[int, int]]) -> np.ndarray:
    """What falls into an episode waits until the token, from row 0 at its begin, comes by."""
    events = events.copy()
    for begin, end in episodes:
        part = slice(*np.searchsorted(events["t"], [begin, end]))
        t_us, pass_us = events["t"][part], events["y"][part].astype(np.int64) * ROUND_US // HEIGHT
        events["t"][part] += (pass_us - (t_us - begin)) % ROUND_US
    return events[np.argsort(events["t"], kind="stable")]


def test_a_token_is_found_with_its_round_and_its_episodes() -> None:
    episodes = [(begin, begin + 30_000) for begin in range(50_000, 1_900_000, 100_000)]
    found = find_token_scan(scanned(free(), episodes), HEIGHT)
    assert found is not None
    assert found.round_us == pytest.approx(ROUND_US, rel=0.03)  # frequencies are tried every 60 Hz
    assert found.share == pytest.approx(0.03 * 19 / SECONDS, rel=0.1)
    assert found.episode_us == pytest.approx(30_000, rel=0.1)


def test_rows_that_come_as_they_like_are_no_scan() -> None:
    assert find_token_scan(free(), HEIGHT) is None


def test_a_burst_now_and_then_is_no_token() -> None:
    """One millisecond, all rows in order, ten times: the bus reads a burst so."""
    assert (
        find_token_scan(scanned(free(), [(t, t + 1000) for t in range(0, 2_000_000, 200_000)]), HEIGHT)
        is None
    )


def test_too_few_events_are_no_scan() -> None:
    assert find_token_scan(scanned(free(20_000), [(0, 2_000_000)]), HEIGHT) is None
    assert find_token_scan(free()[:3], HEIGHT) is None
