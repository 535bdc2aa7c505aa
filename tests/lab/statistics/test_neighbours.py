"""Group I: neighbouring pixels, rows, columns, radius.

Bounds are 4.5 standard deviations or more wide: another seed would fail once in 100 000 times.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_lab.statistics import Setting
from voltcam_lab.statistics.neighbours import EDGES_MS, RINGS, ring_of

from .streams import HEIGHT, PIXELS, WIDTH, poisson, seen, still, stream

SECONDS = 8.0


@pytest.fixture(scope="module")
def rest() -> Setting:
    return still(SECONDS)


def test_neighbours_only_next_to_each_other(rest: Setting) -> None:
    middle = 5 * WIDTH + 5
    pair = stream([1000, 1100], [middle, middle + 1])
    apart = stream([1000, 1100], [middle, middle + 2])
    edge = stream([1000, 1100], [WIDTH - 1, WIDTH])  # ends of two rows
    names = ("I", "a neighbour just before")
    assert seen(rest, pair, *names, "same polarity", "0.002 to 0.2 ms").sum() == 1
    assert seen(rest, pair, *names).sum() == 1
    assert seen(rest, apart, *names).sum() == seen(rest, edge, *names).sum() == 0
    assert seen(rest, stream(1000, [middle, middle + 1]), *names, "below 0.002 ms").sum() == 2


def test_lines_that_differ(rest: Setting) -> None:
    rate_hz = np.full((HEIGHT, WIDTH), 5.0)
    even = seen(
        rest, poisson(np.random.default_rng(10), rate_hz.ravel()), "I", "spread over lines", "at rest"
    )
    rate_hz[7] *= 2
    uneven = seen(
        rest, poisson(np.random.default_rng(10), rate_hz.ravel()), "I", "spread over lines", "at rest"
    )
    assert even[0] < 4 * (HEIGHT + 4.5 * np.sqrt(2 * HEIGHT))  # chi squared in each part
    assert uneven[0] > 2 * even[0]
    assert uneven[1] < 0.6 * uneven[0]


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_neighbours_are_counted_one_by_one(rest: Setting, seed: int) -> None:
    """Each event against the last one of each of its four neighbours; those of the same stamp count."""
    rng = np.random.default_rng(seed)
    place = rng.permutation(400 * 36)[:150]
    y, x = np.divmod(place % 36, 6)
    events = stream(1 + place // 36 * 40, y * WIDTH + x, rng.random(150) < 0.5)
    wanted = np.zeros((2, len(EDGES_MS)), int)
    for t, x, y, on in events.tolist():
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            before = [
                (other_t, other_on)
                for other_t, other_x, other_y, other_on in events.tolist()
                if (other_x, other_y) == (x + dx, y + dy) and other_t <= t
            ]
            if before and t - max(before)[0] < 1000 * EDGES_MS[-1]:
                other_t, other_on = max(before)
                lag = sum(t - other_t >= 1000 * edge for edge in EDGES_MS)
                wanted[int(other_on == on), lag] += 1
    found = seen(rest, events, "I", "a neighbour just before", "rest").reshape(2, -1)
    assert found.tolist() == wanted.tolist()


def test_rings_have_equal_areas_and_lie_about_the_centre(rest: Setting) -> None:
    rings = ring_of(rest).reshape(HEIGHT, WIDTH)
    assert np.bincount(rings.ravel()).tolist() == [PIXELS // RINGS] * RINGS
    assert rings[HEIGHT // 2, WIDTH // 2] == 0
    assert rings[0, 0] == rings[-1, -1] == RINGS - 1
    assert (rings == rings[::-1, ::-1]).mean() > 0.98  # ties at an edge
