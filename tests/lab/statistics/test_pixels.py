"""Group C: pixels that differ from the others.

Bounds are 4.5 standard deviations or more wide: another seed would fail once in 100 000 times.
"""

import numpy as np
import pytest

from voltcam_lab.statistics import Setting
from voltcam_lab.statistics.pixels import PRODUCTS, expected, pixel_scores

from .streams import PIXELS, poisson, seen, still

SECONDS = 8.0


@pytest.fixture(scope="module")
def rest() -> Setting:
    return still(SECONDS)


def test_only_what_lasts_differs_twice(rest: Setting) -> None:
    rng = np.random.default_rng(2)
    alike = seen(rest, poisson(rng, 4.0), "C", "differs twice", "ON at rest x ON at rest")
    unlike = seen(
        rest, poisson(rng, 4 * rng.gamma(4, 0.25, PIXELS)), "C", "differs twice", "ON at rest x ON at rest"
    )
    assert abs(alike[0]) < 4.5 * np.sqrt(PIXELS)
    assert unlike[0] > 10 * np.sqrt(PIXELS)  # (4 Hz x 4 s x 2 parts)/4 variance for each pixel


def test_hot_pixels_are_counted(rest: Setting) -> None:
    rate_hz = np.full(PIXELS, 3.0)
    rate_hz[[50, 200]] = 50
    events = poisson(np.random.default_rng(3), rate_hz)
    assert seen(rest, events, "C", "pixels far above", "ON at rest", "16")[0] == 4  # in both parts of time


def test_events_are_dealt_out_by_the_pixels_own_ways() -> None:
    """ON by rises, OFF by falls, both at rest by time: none is lost, none is made."""
    rng = np.random.default_rng(13)
    n, path = rng.integers(0, 9, (4, 4, 7)).astype(float), rng.uniform(0, 2, (4, 3, 7))
    wanted = expected(n, path)
    assert wanted.sum(axis=-1) == pytest.approx(n.sum(axis=-1))
    for kind, way in enumerate((0, 1, 2, 2)):
        share = path[1, way] / path[1, way].sum()
        assert wanted[1, kind] == pytest.approx(share * n[1, kind].sum())
    assert not expected(n, np.zeros_like(path)).any()


def test_scores_of_poisson_counts_have_a_spread_of_about_one() -> None:
    counts = np.random.default_rng(14).poisson(50.0, 20_000).astype(float)
    score = pixel_scores(counts, np.full(counts.shape, 50.0))
    assert score.mean() == pytest.approx(0, abs=4.5 / np.sqrt(20_000))
    assert score.std() == pytest.approx(np.sqrt(50 / 51), abs=4.5 / np.sqrt(2 * 20_000))


def test_what_makes_pixels_differ_in_one_half_only_is_no_difference_that_lasts(rest: Setting) -> None:
    """Uneven by one pattern in two of four blocks in turn, by its mirror image in the other two."""
    uneven = 8 * np.random.default_rng(15).gamma(4, 0.25, PIXELS)
    fair = np.random.default_rng(16)
    events = np.concatenate([poisson(fair, uneven), poisson(fair, uneven[::-1])])
    block = np.searchsorted(rest.block_edges_us, events["t"]) - 1
    first = np.arange(len(events)) < len(events) // 2
    turned = events[(block % 4 < 2) == first]
    kept = events[first]
    twice = [seen(rest, e, "C", "differs twice", "ON at rest x ON at rest")[0] for e in (turned, kept)]
    assert len(PRODUCTS) == len(seen(rest, kept, "C", "differs twice"))
    assert abs(twice[0]) < 0.3 * twice[1]
