"""The tests' own camera against closed forms: if it is wrong, calibration and diagnosis are judged wrongly.

Seeded, so that a result does not change from run to run; tolerances are at least 4 standard errors.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import invgauss, kstest
from tests.generator import (
    FAULTS,
    Base,
    Scene,
    draw_base,
    draw_effect,
    draw_film,
    draw_fine_scene,
    draw_photo_scene,
    draw_scene,
    record,
    shuffled_polarity,
    still_scene,
)  # fmt: skip
from tests.generator.probes import LEAKY, QUIET, counts, moving

Floats = NDArray[np.float64]


def test_leak_intervals_are_inverse_gaussian() -> None:
    recording = record(still_scene(np.full((36, 48), 128.0)), LEAKY, seconds=4, seed=2)
    e = recording.events
    assert e["p"].all()
    order = np.lexsort((e["t"], e["x"], e["y"]))
    first = np.cumsum(counts(recording).ravel())[:-1]
    # as many of each pixel: none is cut off for being long
    gap = np.concatenate([np.diff(t)[:40] for t in np.split(e["t"][order], first)]) * 1e-6
    assert len(gap) == 40 * 36 * 48
    mu, sigma = 12.8, 1e-3 * np.sqrt(128) / 148 * 1e3
    mean, shape = 1 / mu, 1 / sigma**2
    assert gap.mean() == pytest.approx(mean, rel=4 * sigma * np.sqrt(1 / mu) / np.sqrt(len(gap)))
    assert gap.std() == pytest.approx(sigma / mu**1.5, rel=0.012)
    assert kstest(gap, invgauss(mean / shape, scale=shape).cdf).pvalue > 0.01


def test_step_does_not_matter() -> None:
    scene = draw_scene(np.random.default_rng(3), 24, 24)
    base = draw_base(np.random.default_rng(3), camera="davis240c")
    fine, coarse = (record(scene, base, seconds=2, seed=4, step_us=step) for step in (50, 400))
    assert len(coarse.events) == pytest.approx(len(fine.events), rel=4 * np.sqrt(2 / len(fine.events)))
    assert coarse.events["p"].mean() == pytest.approx(fine.events["p"].mean(), abs=0.01)


def ideal_counts(log: Floats, start: Floats, base: Base) -> Floats:
    """(2, pixels) ON and OFF events of noise-free integrate and fire along ln(L+k2), (times, pixels)."""
    level, on, off = base.k1 * log[0] - start, np.zeros(log.shape[1]), np.zeros(log.shape[1])
    for row in base.k1 * log:
        up = np.maximum(np.floor((row - level) / base.theta_on), 0)
        down = np.maximum(np.floor((level - row) / base.theta_off), 0)
        level += up * base.theta_on - down * base.theta_off
        on, off = on + up, off + down
    return np.stack([on, off])


def test_contrast_events_are_k1_times_the_logarithm() -> None:
    """Without noise, each pixel has a start voltage from which integrate and fire counts these events."""
    scene = draw_scene(np.random.default_rng(7), 24, 12)
    base = replace(QUIET, theta_on=1.25, theta_off=0.8)
    recording = record(scene, base, seconds=0.6, seed=1)
    log = np.log(scene.radiance(np.arange(0, 600_001, 400)).reshape(1501, -1).astype(float) + base.k2)
    found = np.stack([counts(recording, polarity).ravel() for polarity in (True, False)])
    assert found.sum() > 500
    explained = np.zeros(found.shape[1], bool)
    for start in np.linspace(-0.79, 1.24, 50):
        explained |= np.all(found == ideal_counts(log, np.full(explained.shape, start), base), axis=0)
    assert explained.mean() > 0.98  # 50 starts only
    net = 1.25 * counts(recording, True) - 0.8 * counts(recording, False)
    change = base.k1 * (log[-1] - log[0]).reshape(net.shape)
    assert np.all(np.abs(net - change) < 2.05)  # the band, once at each end


def test_driftless_noise_leaves_a_band_at_its_rate() -> None:
    """Mean exit time of a Brownian motion from (-B, A): A B / sigma^2, by ON with B/(A+B)."""
    base = replace(QUIET, theta_on=1.25, theta_off=0.8, k6=2e-3)
    recording = record(still_scene(np.full((24, 24), 10.0)), base, seconds=3, seed=1)
    late = recording.events[recording.events["t"] > 500_000]
    assert len(late) == pytest.approx(2.5 * 576 * 4, rel=0.04)
    assert late["p"].mean() == pytest.approx(0.8 / 2.05, abs=0.03)


def test_same_seed_same_recording_on_any_thread() -> None:
    scene, base = draw_scene(np.random.default_rng(1), 24, 24), draw_base(np.random.default_rng(1))
    effect = draw_effect(np.random.default_rng(1), "latency", "medium")
    with ThreadPoolExecutor(2) as pool:
        one, same = pool.map(lambda _: record(scene, base, [effect], 1, seed=3), range(2))
    other = record(scene, base, [effect], 1, seed=4)
    assert np.array_equal(one.events, same.events)
    assert not np.array_equal(one.events, other.events)
    assert np.array_equal(one.frames, other.frames)
    elsewhere = draw_scene(np.random.default_rng(2), 24, 24)
    assert not np.array_equal(one.frames, record(elsewhere, base, [], 1).frames)


def test_a_recording_is_what_a_reader_expects() -> None:
    recording = moving(None, seconds=1)
    assert np.all(np.diff(recording.events["t"]) >= 0)
    assert recording.events["t"][0] >= 0
    assert recording.events["t"][-1] < 1_000_000
    assert recording.frames.shape == (201, 24, 24)
    assert recording.frames.dtype == np.uint8
    assert recording.frame_t_us[[0, 1, -1]].tolist() == [0, 5000, 1_000_000]
    assert recording.truth["base"]["k1"] == QUIET.k1


def test_each_half_second_rests_creeps_and_runs() -> None:
    for seed in range(5):
        scene = draw_scene(np.random.default_rng(seed))
        for block in scene.speed[10_000:-10_000][: 24 * 5000].reshape(24, -1):  # .5 s each
            assert block.min() == 0
            assert np.any((block > 3.9) & (block < 12.1))
            assert block.max() > 45
        dn = scene.radiance(np.arange(0, 6_000_000, 50_000))
        still = np.ptp(dn, axis=0) == 0
        assert 0.3 < still.mean() < 0.6
        assert (dn[0][still].min(), dn[0][still].max()) == (10, 230)
        assert 7 < dn.min() < 14


def test_shuffled_polarity_keeps_everything_else() -> None:
    recording = moving(None, seconds=1)
    shuffled = shuffled_polarity(recording).events
    assert np.array_equal(shuffled["t"], recording.events["t"])
    assert shuffled["p"].sum() == recording.events["p"].sum()
    assert (shuffled["p"] != recording.events["p"]).mean() > 0.3


def test_film() -> None:
    scene = draw_scene(np.random.default_rng(5), 24, 24)
    films = {fault: draw_film(np.random.default_rng(1), fault) for fault in FAULTS}
    exact = record(scene, QUIET, [], 0.5, fps=25, eight_bit=False)
    assert exact.frames.shape[0] == 13
    assert np.allclose(exact.frames, scene.radiance(exact.frame_t_us), atol=1e-3)
    got = {name: record(scene, QUIET, [], 0.5, 25, 0, False, film=film) for name, film in films.items()}
    light = exact.frames.astype(float)
    assert np.allclose(got["gamma"].frames, 255 * (light / 255) ** films["gamma"].gamma, atol=1e-3)
    assert np.allclose(got["black_level"].frames, light + films["black_level"].black_level_dn, atol=1e-3)
    assert np.allclose(got["clipping"].frames, np.minimum(light * films["clipping"].gain, 255), atol=1e-3)
    blurred = got["exposure_blur"].frames
    assert np.abs(blurred - light).max() > 5
    assert all(np.array_equal(exact.events, each.events) for each in got.values())
    eight = record(scene, QUIET, [], 0.5, fps=25).frames
    assert np.array_equal(eight, np.rint(exact.frames).astype(np.uint8))


def test_unknown_names_are_told() -> None:
    with pytest.raises(ValueError, match="no effect 'glare'"):
        draw_effect(np.random.default_rng(1), "glare", "weak")
    with pytest.raises(ValueError, match="draws a longer one"):
        record(draw_scene(np.random.default_rng(1), 12, 12, seconds=1), QUIET, seconds=3)


@pytest.mark.parametrize("draw", [draw_fine_scene, draw_photo_scene])
def test_scenes_that_never_rest_are_continuous_light(draw: Callable[..., Scene]) -> None:
    """Twice as short a time halves the change; each seed has its own."""
    one, other = (draw(np.random.default_rng(seed), seconds=2.0) for seed in (1, 2))
    images = one.radiance(np.array([0, 500, 1000, 1_000_000]))
    assert images.min() > 0
    assert images.max() < 320  # what tables of the pixels hold
    half, whole, later = (np.abs(image - images[0]).mean() for image in images[1:])
    assert 0 < half < 0.6 * whole
    assert whole < 0.1 * later
    assert np.abs(other.radiance(np.array([0])) - images[0]).mean() > 1


def test_recordings_of_one_camera_share_its_patterns() -> None:
    scene, base = draw_scene(np.random.default_rng(5), 24, 24), draw_base(np.random.default_rng(5))
    rng = np.random.default_rng(6)
    names = ("threshold_mismatch", "hot_pixels", "dead_pixels")
    effects = [draw_effect(rng, name, "strong") for name in names]
    one, other = (record(scene, base, effects, 1, seed=seed, camera_seed=9) for seed in (1, 2))
    for name, pattern in one.truth["patterns"].items():
        assert np.array_equal(pattern, other.truth["patterns"][name]), name
    hot = one.truth["patterns"]["hot_pixels"][0]
    times = [r.events["t"][(r.events["x"] == hot[0]) & (r.events["y"] == hot[1])] for r in (one, other)]
    assert not np.array_equal(*times)  # fires at other times
    third = record(scene, base, effects, 1, seed=1, camera_seed=8)
    assert not np.array_equal(
        third.truth["patterns"]["theta_on_factor"], one.truth["patterns"]["theta_on_factor"]
    )


def test_light_scales_all_of_a_scene() -> None:
    scene = draw_scene(np.random.default_rng(5), 24, 24)
    t_us = np.array([0, 700_000])
    assert scene.lit(0.5).radiance(t_us) == pytest.approx(0.5 * scene.radiance(t_us), rel=1e-5)
