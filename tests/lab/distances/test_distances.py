"""Closed forms, properties of distances, and a real recording's floors.

Statistics are seeded; their bounds are at least five standard deviations wide unless a line says otherwise.
"""

import os
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from voltcam_lab.distances import (
    MEASURES,
    FrameLight,
    Region,
    Yardstick,
    by_pixels,
    by_time,
    held_out,
    noise_rates,
)
from voltcam_lab.distances import counts as count_measures
from voltcam_lab.distances import inter_event_intervals as interval_measures
from voltcam_lab.distances import patches as patch_measures
from voltcam_lab.recordings import load
from voltcam_simulator import EVENT
from voltcam_simulator.effect import Events

WIDTH, HEIGHT, END_US = 72, 60, 1_600_000
WHOLE = Region.whole(WIDTH, HEIGHT, 0, END_US)
DATA = Path(os.environ.get("VOLTCAM_DATA", Path(__file__).parents[4] / "shared" / "data"))


def stream(t: np.ndarray, x: np.ndarray, y: np.ndarray, p: np.ndarray) -> Events:
    events = np.empty(len(t), EVENT)
    events["t"], events["x"], events["y"], events["p"] = t, x, y, p
    return events[np.argsort(events["t"], kind="stable")]


def poisson(seed: int, rate_hz: float = 40.0, end_us: int = END_US, width: int = WIDTH) -> Events:
    """Every pixel at the same rate, polarities by toss."""
    rng = np.random.default_rng(seed)
    n = rng.poisson(rate_hz * end_us / 1e6 * width * HEIGHT)
    return stream(
        rng.integers(0, end_us, n), rng.integers(0, width, n), rng.integers(0, HEIGHT, n), rng.random(n) < 0.5
    )


def renewal(rng: np.random.Generator, mean_us: float, per_pixel: int = 100) -> Events:
    """Exponential intervals, ON only, per_pixel + 1 events at each pixel, however long that takes."""
    spans = np.ceil(rng.exponential(mean_us, (HEIGHT, WIDTH, per_pixel))).astype(np.int64)
    t = np.concatenate([np.zeros((HEIGHT, WIDTH, 1), np.int64), np.cumsum(spans, axis=2)], axis=2)
    y, x, _ = np.indices(t.shape)
    return stream(t.ravel(), x.ravel(), y.ravel(), np.ones(t.size, bool))


def still_light(frames: int = 51, width: int = WIDTH) -> FrameLight:
    """Left half 50 DN, right half 150 DN, for END_US."""
    image = np.full((HEIGHT, width), 50, np.uint8)
    image[:, width // 2 :] = 150
    return FrameLight(np.repeat(image[None], frames, axis=0), np.linspace(0, END_US, frames).astype(np.int64))


def test_a_stream_is_at_no_distance_from_itself() -> None:
    real = poisson(1)
    row = Yardstick(real, WHOLE, still_light()).distances(real)
    assert list(row) == list(MEASURES)
    for name, measure in MEASURES.items():
        if measure.best is not None:
            assert row[name] == pytest.approx(measure.best, abs=1e-12), name


def test_distances_are_symmetric() -> None:
    a, b = poisson(1), poisson(2, rate_hz=25)
    same = [interval_measures.same_polarity(events, WHOLE) for events in (a, b)]
    strata = interval_measures.IntervalStrata.of(same[0], still_light())
    cells, light = count_measures.watched(WHOLE), still_light()
    images = [count_measures.count_images(events, WHOLE) for events in (a, b)]
    noise = [noise_rates(events, WHOLE, light) for events in (a, b)]
    for distance, (first, second) in (
        (interval_measures.wasserstein, same),
        (interval_measures.total_variation, same),
        (lambda one, other: interval_measures.stratified_variation(one, other, strata), same),
        (lambda one, other: count_measures.correlation(one, other, cells), images),
        (count_measures.noise_difference, noise),
    ):
        assert distance(first, second) == pytest.approx(distance(second, first))
        assert distance(first, second) != distance(first, first)


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


def test_halves_of_a_poisson_stream_are_as_good_as_the_same() -> None:
    yardstick = Yardstick(poisson(4, rate_hz=60), WHOLE, still_light())
    for floor in (yardstick.floor_by_pixels(), yardstick.floor_by_time()):
        assert floor["W1"] < 0.01
        assert floor["TV"] < 0.02
        assert floor["TVs"] < 0.03
        assert floor["pair"] < 0.01
        assert floor["noise"] < 0.5
        assert abs(floor["AUC"] - 0.5) < 0.15
        assert abs(floor["ratio"]) < 0.05
        assert floor["quiet_on"] < 0.5


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


stretches = st.lists(st.tuples(st.integers(0, 60), st.integers(1, 20)), max_size=6)


@given(keep=stretches, hide=stretches, edges=st.lists(st.integers(0, 90), min_size=2, unique=True))
def test_regions_are_what_counting_microseconds_says(
    keep: list[tuple[int, int]], hide: list[tuple[int, int]], edges: list[int]
) -> None:
    live = np.zeros(100, bool)
    pieces, at = [], 0
    for gap, length in keep:  # stretches are in order and apart
        begin = at + gap % 5
        at = min(begin + length, 90)
        if begin < at:
            pieces.append((begin, at))
            live[begin:at] = True
    windows = np.array([(begin, begin + length) for begin, length in hide], np.int64).reshape(-1, 2)
    for begin, end in windows:
        live[begin:end] = False
    region = Region.whole(2, 1, 0, 100).during(np.array(pieces, np.int64).reshape(-1, 2)).without(windows)
    assert region.pixel_seconds == pytest.approx(2 * live.sum() / 1e6)
    events = stream(np.arange(100), np.zeros(100), np.zeros(100), np.ones(100, bool))
    assert region.of(events)["t"].tolist() == np.flatnonzero(live).tolist()
    edges = sorted(edges)
    counted = [live[first:last].sum() for first, last in pairwise(edges)]
    assert region.live_in(np.array(edges, np.int64)).tolist() == counted
    outside = np.zeros(100, bool)
    for begin, end in region.outside().tolist():
        outside[max(begin, 0) : max(end, 0)] = True
    assert (outside == ~live).all()


def test_halves_share_nothing_and_leave_nothing_out() -> None:
    for first, second in (by_pixels(WHOLE, 12), by_time(WHOLE, 100_000)):
        assert first.pixel_seconds + second.pixel_seconds == pytest.approx(WHOLE.pixel_seconds)
        both = first.on(second.pixels).during(second.times)
        assert both.pixel_seconds == 0
    fitting, judging = held_out(WHOLE)
    assert not (fitting.pixels & judging.pixels).any()
    assert not len(fitting.during(judging.times).times)


def test_what_is_held_out_has_halves_of_its_own() -> None:
    judging = held_out(WHOLE)[1]
    for first, second in (by_pixels(judging, 1), by_pixels(judging, 12), by_time(judging, 100_000)):
        assert first.pixel_seconds == pytest.approx(second.pixel_seconds, rel=0.01)


def test_count_images_correlate_where_streams_share_their_rates() -> None:
    """Two Poisson streams of a common rate with variance V over cells: r = V / (V + mean)."""
    rng = np.random.default_rng(8)
    rates = rng.gamma(2.0, 2.0, (32, HEIGHT // 4, WIDTH // 4))  # mean 4, variance 8
    cells = np.array(np.nonzero(np.ones_like(rates))).T

    def drawn() -> Events:
        n = rng.poisson(rates.ravel())
        bins, row, column = np.repeat(cells, n, axis=0).T
        size = len(bins)
        return stream(
            bins * 50_000 + rng.integers(0, 50_000, size),
            column * 4 + rng.integers(0, 4, size),
            row * 4 + rng.integers(0, 4, size),
            rng.random(size) < 0.5,
        )

    images = [count_measures.count_images(drawn(), WHOLE) for _ in range(2)]
    assert images[0].shape == rates.shape
    found = count_measures.correlation(*images, count_measures.watched(WHOLE))
    assert found == pytest.approx(8 / 12, abs=0.06)


def test_dispersion_is_the_spread_of_rates_over_pixels() -> None:
    rng = np.random.default_rng(9)
    even = np.full((HEIGHT, WIDTH), 30.0)
    uneven = even * rng.gamma(4.0, 0.25, even.shape)  # coefficient of variation 1/2

    def of(counts: np.ndarray) -> float:
        y, x = (np.repeat(axis.ravel(), counts.ravel()) for axis in np.indices(counts.shape))
        return count_measures.dispersion(stream(np.zeros(len(x)), x, y, np.ones(len(x), bool)), WHOLE)

    assert abs(of(rng.poisson(even))) < 0.08
    assert of(rng.poisson(uneven)) == pytest.approx(0.5, abs=0.08)
    assert of(even.astype(int)) == pytest.approx(-1 / np.sqrt(30))  # all alike: short of Poisson by 1/n


def test_noise_is_counted_where_light_stands_still() -> None:
    light = still_light()
    moving = light.images.copy()
    moving[::2, :, 54:] = 250  # flickers from column 54 on
    light = FrameLight(moving, light.t_us)
    rng = np.random.default_rng(11)
    rate = np.where(np.arange(WIDTH) < WIDTH // 2, 3.0, 6.0)
    counts = rng.poisson(rate * END_US / 1e6, (HEIGHT, WIDTH))
    counts[:, 54:] = 500
    y, x = (np.repeat(axis.ravel(), counts.ravel()) for axis in np.indices(counts.shape))
    events = stream(rng.integers(0, END_US, len(x)), x, y, np.ones(len(x), bool))
    noise = noise_rates(events, WHOLE, light)
    assert noise.on[1] == pytest.approx(3.0, rel=0.15)  # 32 to 64 DN
    assert noise.on[4] == pytest.approx(6.0, rel=0.3)  # 128 to 160 DN, what is left of it
    assert np.isnan(noise.on[0])
    assert not np.nansum(noise.off)
    quiet = count_measures.quiet_on_rate(events, WHOLE, light)
    assert quiet == pytest.approx(np.nansum(noise.on * noise.pixel_seconds) / noise.pixel_seconds.sum())


def test_patches_of_another_law_are_told_apart_the_same_each_time() -> None:
    """As many events, but in bursts of two 300 us apart."""
    real, other = poisson(21), poisson(22, rate_hz=20)
    again = other.copy()
    again["t"] = np.minimum(again["t"] + 300, END_US - 1)
    bursts = np.sort(np.concatenate([other, again]), order="t")
    found = patch_measures.auc(real, bursts, WHOLE)
    assert found > 0.95
    assert patch_measures.auc(real, bursts, WHOLE) == found
    assert abs(patch_measures.auc(real, poisson(23), WHOLE) - 0.5) < 0.15


def test_too_few_events_are_no_distance() -> None:
    few = poisson(1)[:10]
    row = Yardstick(few, WHOLE, still_light()).distances(few)
    assert all(np.isnan(row[name]) for name in ("W1", "TV", "TVs", "pair", "AUC"))
    nothing = Yardstick(few[:0], WHOLE, still_light()).distances(few[:0])
    assert np.isnan(nothing["b4"])
    assert np.isnan(nothing["dispersion"])
    assert nothing["on"] == 0


@pytest.mark.skipif(not (DATA / "slider_depth").is_dir(), reason="slider_depth is not on this machine")
def test_the_floors_of_a_real_recording() -> None:
    """As another implementation found them: W1 .002, TVs .010, pair .002, b4 .977, AUC .51."""
    recording = load(DATA / "slider_depth")
    assert recording.frames is not None
    assert recording.frame_t_us is not None
    t_us = recording.frame_t_us
    windows = np.concatenate([t_us[:, None] + window for window in ([-400, -50], [550, 1500])])
    region = Region.whole(240, 180, int(t_us[0]), int(t_us[-1])).without(windows)
    floor = Yardstick(recording.events, region, FrameLight(recording.frames, t_us)).floor_by_pixels()
    assert floor["W1"] == pytest.approx(0.002, abs=0.001)
    assert floor["TVs"] == pytest.approx(0.010, abs=0.003)
    assert floor["pair"] == pytest.approx(0.002, abs=0.001)
    assert floor["b4"] == pytest.approx(0.977, abs=0.01)
    assert floor["AUC"] == pytest.approx(0.51, abs=0.04)
