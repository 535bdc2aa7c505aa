"""Distances and figures from numbers of events."""

from dataclasses import replace

import numpy as np
import pytest
from tests.lab.distances.made import END_US, HEIGHT, WHOLE, WIDTH, poisson, still_light, stream

from voltcam_lab.distances import (
    FrameLight,
    Region,
    noise_rates,
)
from voltcam_lab.distances import counts as count_measures
from voltcam_simulator.effect import Events


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


def test_distances_are_symmetric() -> None:
    a, b, light = poisson(1), poisson(2, rate_hz=25), still_light()
    cells = count_measures.watched(WHOLE)
    images = [count_measures.count_images(events, WHOLE) for events in (a, b)]
    found = [count_measures.correlation(*pair, cells) for pair in (images, images[::-1])]
    assert found[0] == pytest.approx(found[1])
    assert found[0] != pytest.approx(1)
    noise = [noise_rates(events, WHOLE, light) for events in (a, b)]
    different = count_measures.noise_difference(*noise)
    assert different == pytest.approx(count_measures.noise_difference(*noise[::-1]))
    assert different > count_measures.noise_difference(noise[0], noise[0]) == 0


def test_each_event_is_in_the_image_of_its_block_and_time() -> None:
    """A sensor that its blocks do not fill: 10 x 6 pixels are 3 x 2 blocks."""
    region = Region.whole(10, 6, 1000, 151_000)
    events = stream(
        np.array([1000, 50_999, 51_000, 150_999]),
        np.array([0, 9, 3, 4]),
        np.array([0, 5, 4, 3]),
        np.ones(4, bool),
    )
    images = count_measures.count_images(events, region)
    assert images.shape == (3, 2, 3)
    assert np.argwhere(images).tolist() == [[0, 0, 0], [0, 1, 2], [1, 1, 0], [2, 0, 1]]
    assert images.sum() == 4


def test_cells_are_watched_that_are_half_in_the_region_in_time_and_space() -> None:
    """Of 10 x 6 pixels the blocks at the edge have 8 and 4 of 16; the second 50 ms is live for 24 of them."""
    region = Region.whole(10, 6, 0, 100_000).without(np.array([[74_000, 100_000]]))
    cells = count_measures.watched(region)
    assert cells[0].tolist() == [[True, True, True], [True, True, False]]
    assert not cells[1].any()
    assert count_measures.watched(replace(region, hidden=region.hidden + 1000))[1, 0, 0]


def test_what_is_constant_correlates_with_nothing() -> None:
    flat, other = np.ones((2, 3, 3), np.int64), np.arange(18).reshape(2, 3, 3)
    assert np.isnan(count_measures.correlation(flat, other, np.ones((2, 3, 3), bool)))


def test_rates_are_events_over_pixels_and_seconds() -> None:
    events = poisson(3, rate_hz=10)
    half = WHOLE.on(np.arange(WIDTH) < WIDTH // 2)
    inside = events[events["x"] < WIDTH // 2]
    seconds = END_US * 1e-6 * HEIGHT * (WIDTH // 2)
    wanted = [np.count_nonzero(inside["p"] == on) / seconds for on in (True, False)]
    assert count_measures.rates(events, half) == pytest.approx(wanted)
