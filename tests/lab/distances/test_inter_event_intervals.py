"""Distances between intervals: closed forms, and who is compared with whom."""

from dataclasses import replace

import numpy as np
import pytest
from tests.lab.distances.made import HEIGHT, WHOLE, WIDTH, poisson, renewal, still_light, stream

from voltcam_lab.distances import (
    Region,
)
from voltcam_lab.distances import inter_event_intervals as interval_measures
from voltcam_lab.light.known import KnownLight
from voltcam_simulator.effect import Events


@pytest.mark.parametrize("ratio", [1.5, 3.0, 10.0])
def test_exponential_intervals_at_a_ratio_of_rates(ratio: float) -> None:
    """Wasserstein in decades is |log10 r|; total variation r^(-1/(r-1)) - r^(-r/(r-1))."""
    rng = np.random.default_rng(5)
    forever = Region.whole(WIDTH, HEIGHT, 0, 10**12)
    slow, fast = (interval_measures.same_polarity(renewal(rng, mean), forever) for mean in (1e6, 1e6 / ratio))
    assert interval_measures.wasserstein(slow, fast) == pytest.approx(np.log10(ratio), abs=0.01)
    variation = ratio ** (-1 / (ratio - 1)) - ratio ** (-ratio / (ratio - 1))
    # Bins of a tenth of a decade can only lose of it.
    assert interval_measures.total_variation(slow, fast) == pytest.approx(variation, abs=0.012)


def test_strata_tell_what_the_overall_law_hides() -> None:
    """Bright pixels fast and dark ones slow, against the reverse: the same intervals on the whole."""
    rng = np.random.default_rng(3)

    def halves(left_us: float, right_us: float) -> Events:
        left, right = renewal(rng, left_us, 20), renewal(rng, right_us, 20)
        return np.sort(
            np.concatenate([left[left["x"] < WIDTH // 2], right[right["x"] >= WIDTH // 2]]), order="t"
        )

    forever = Region.whole(WIDTH, HEIGHT, 0, 10**12)
    a, b = (
        interval_measures.same_polarity(events, forever) for events in (halves(1e3, 1e5), halves(1e5, 1e3))
    )
    strata = interval_measures.IntervalStrata.of(a, still_light())
    assert interval_measures.total_variation(a, b) < 0.05
    # By brightness nearly all differs; by change, which there is none of, nothing does. Half of six.
    assert interval_measures.stratified_variation(a, b, strata) > 0.4


def test_intervals_end_at_a_stretch_and_go_on_across_what_is_hidden() -> None:
    t = np.array([100, 200, 400, 1100, 1300])
    events = stream(t, np.full(5, 3), np.full(5, 2), np.ones(5, bool))
    region = Region.whole(8, 8, 0, 2000).during(np.array([[0, 1000], [1000, 2000]]))
    spans = 10 ** interval_measures.same_polarity(events, region).decades
    assert np.sort(spans) == pytest.approx([100, 200, 200])
    hidden = region.without(np.array([[150, 250]]))
    assert np.sort(10 ** interval_measures.same_polarity(events, hidden).decades) == pytest.approx([200, 300])


def test_pairs_are_told_by_both_polarities() -> None:
    t, p = np.array([0, 10, 110, 1110]), np.array([True, True, False, True])
    events = stream(t, np.zeros(4), np.zeros(4), p)
    lags = interval_measures.any_polarity(events, Region.whole(4, 4, 0, 5000))
    assert dict(zip(lags.group.tolist(), lags.decades.tolist(), strict=True)) == {3: 1.0, 2: 2.0, 1: 3.0}


def some(decades: np.ndarray, group: int) -> interval_measures.Intervals:
    zeros = np.zeros(len(decades), np.int64)
    return interval_measures.Intervals(
        decades, zeros + group, zeros, zeros.astype(np.uint16), zeros.astype(np.uint16)
    )


def joined(*parts: interval_measures.Intervals) -> interval_measures.Intervals:
    return interval_measures.Intervals(
        *(
            np.concatenate([getattr(one, name) for one in parts])
            for name in ("decades", "group", "t_us", "x", "y")
        )
    )


def test_distances_are_symmetric() -> None:
    a, b = (
        interval_measures.same_polarity(poisson(seed, rate_hz=rate), WHOLE)
        for seed, rate in ((1, 40), (2, 25))
    )
    strata = interval_measures.IntervalStrata.of(a, still_light())
    for distance in (
        interval_measures.wasserstein,
        interval_measures.total_variation,
        lambda one, other: interval_measures.stratified_variation(one, other, strata),
    ):
        assert distance(a, b) == pytest.approx(distance(b, a))
        assert distance(a, b) != distance(a, a)


def test_groups_count_by_their_shares_and_small_ones_not_at_all() -> None:
    """Group 0 is shifted by .3 decades, group 1 by .1; of group 2 one stream has 19 intervals."""
    rng = np.random.default_rng(1)
    first, second = rng.uniform(3, 5, 60), rng.uniform(3, 5, 40)
    few = rng.uniform(3, 5, interval_measures.FEWEST - 1)
    a = joined(some(first, 0), some(second, 1), some(few + 1, 2))
    b = joined(some(first + 0.3, 0), some(second + 0.1, 1), some(few, 2))
    assert interval_measures.wasserstein(a, b) == pytest.approx(0.6 * 0.3 + 0.4 * 0.1)
    assert np.isnan(interval_measures.wasserstein(some(few, 0), some(few, 0)))


def test_laws_that_share_no_bin_are_at_a_variation_of_one() -> None:
    low, high = np.linspace(3, 3.9, 50), np.linspace(4, 4.9, 50)
    assert interval_measures.total_variation(some(low, 0), some(high, 0)) == pytest.approx(1)
    half = np.concatenate([low[:25], high[:25]])
    assert interval_measures.total_variation(some(low, 0), some(half, 0)) == pytest.approx(0.5, abs=0.06)


def test_terciles_are_those_of_the_real_intervals() -> None:
    """Light that is 50 DN on the left third, 100, and 150: each third is a tercile."""
    images = np.broadcast_to(50 * (1 + np.arange(WIDTH) * 3 // WIDTH), (51, HEIGHT, WIDTH)).astype(np.uint8)
    light = replace(still_light(), images=images)
    real = interval_measures.same_polarity(poisson(5, rate_hz=5), WHOLE)
    brightness, speed = interval_measures.IntervalStrata.of(real, light).numbers(real)
    third = real.x.astype(int) * 3 // WIDTH
    assert np.corrcoef(brightness, third)[0, 1] > 0.8  # an edge falls into one of the three
    assert not speed.any()


def test_intervals_through_light_that_is_not_known_are_left_out() -> None:
    """A pixel's light is not known from 500 to 600 us, another one's always is."""
    known = KnownLight.everywhere(np.arange(0, 1001, 100), HEIGHT, WIDTH)
    known.gaps[5, 2 * WIDTH + 3] = False
    t = np.array([100, 110, 250, 250, 640, 650])
    x = np.array([3, 4, 3, 4, 3, 4])
    events = stream(t, x, np.full(6, 2), np.ones(6, bool))
    whole = Region.whole(WIDTH, HEIGHT, 0, 1000)
    found = interval_measures.same_polarity(events, whole, known)
    assert 10**found.decades == pytest.approx([150, 140, 400])
    assert len(interval_measures.any_polarity(events, whole).decades) == 4
