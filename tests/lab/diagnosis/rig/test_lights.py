"""Light that frames may have been taken of."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import maximum_filter

from voltcam_lab.diagnosis.rig.lights import known_light, light_behind
from voltcam_lab.diagnosis.rig.settings import DEFAULT_RIG, LightError, RigSettings
from voltcam_lab.light.scene import How, Scene, scene_of
from voltcam_simulator import EVENT


def frames() -> tuple[np.ndarray, np.ndarray]:
    t_us = np.arange(20) * 10_000
    level = 100 + 60 * np.sin(t_us * 1e-6 * 2 * np.pi * 20)
    images = np.tile(level[:, None, None], (1, 8, 8))
    images[:, :, :4] = 42
    return images.astype(np.float32), t_us


@pytest.mark.parametrize("how", ["spline", "cubic", "auto"])
@pytest.mark.parametrize("version", range(DEFAULT_RIG.versions))
def test_at_each_frame_it_is_the_frame(version: int, how: How) -> None:
    taken, t_us = frames()
    shown = {t: image for image, t in light_behind(scene_of(taken, t_us, how), version, DEFAULT_RIG)}
    for image, t in zip(taken, t_us.tolist(), strict=True):
        assert shown[t] == pytest.approx(image, abs=1e-3)


@pytest.mark.parametrize("how", ["spline", "auto"])
def test_versions_differ_where_light_moves_or_next_to_it(how: How) -> None:
    taken, t_us = frames()
    scene = replace(scene_of(taken, t_us, "spline"), how=how)
    first, second = (np.stack([image for image, _ in light_behind(scene, k, DEFAULT_RIG)]) for k in (0, 1))
    assert first[:, :, :3] == pytest.approx(np.full_like(first[:, :, :3], 42), abs=1e-3)
    assert second[:, :, :3] == pytest.approx(np.full_like(first[:, :, :3], 42), abs=1e-3)
    assert np.abs(first - second)[:, :, 4:].max() > 1


def half_way(scene: Scene, settings: RigSettings = DEFAULT_RIG, way: float = 0.5) -> np.ndarray:
    """(M - 1, pixels) what a version adds to the light at such a part of the way from frame to frame."""
    taken, t_us = scene.taken, scene.taken_us
    between = (1 - way) * taken[:-1] + way * taken[1:]
    images = np.stack([taken[:-1], between], axis=1).reshape(-1, *taken.shape[1:]).astype(np.float32)
    times = np.column_stack([t_us[:-1], t_us[:-1] + way * np.diff(t_us)]).ravel().astype(np.int64)
    coarse = replace(scene, images=images, t_us=times)
    shown = np.stack([image for image, _ in light_behind(coarse, 0, settings)])
    return (shown - images)[1::2].reshape(len(between), -1)


def test_errors_have_students_law_in_units_of_what_left_out_frames_ask_for() -> None:
    """With 3 degrees of freedom its median is 0.765 of the scale, and 1 % is above 5.84."""
    rng, t_us = np.random.default_rng(3), np.arange(60) * 10_000
    scene = scene_of(rng.uniform(100, 110, (60, 40, 40)).astype(np.float32), t_us, "cubic")
    settings = replace(DEFAULT_RIG, on_curves=LightError(0.05, 0.0))
    largest = maximum_filter(scene.surprise.reshape(scene.taken.shape), (1, 3, 3)).reshape(60, -1)
    errors = np.abs(half_way(scene, settings)) / np.maximum(largest[:-1], largest[1:])
    assert np.median(errors) == pytest.approx(0.765 * 0.05, rel=0.02)
    assert np.quantile(errors, 0.99) == pytest.approx(5.84 * 0.05, rel=0.05)


def zigzag(amount: float) -> Scene:
    """Half of the pixels go up and down a ramp; to each frame comes so much of its step at random."""
    rng, t_us = np.random.default_rng(4), np.arange(200) * 10_000
    ramp = 100 + 0.5 * np.abs((np.arange(200) + 20) % 80 - 40.0)
    taken = np.tile(ramp[:, None, None], (1, 20, 20))
    taken += amount * 0.5 * rng.uniform(-1, 1, taken.shape)
    taken[:, :, 10:] = 100
    return scene_of(taken.astype(np.float32), t_us, "cubic")


def test_surprise_by_change_is_what_is_not_straight_over_the_step() -> None:
    assert zigzag(0.0).surprise_by_change == pytest.approx(0.0, abs=1e-3)
    little, much = zigzag(0.1).surprise_by_change, zigzag(0.2).surprise_by_change
    assert much == pytest.approx(2 * little, rel=0.1)


def test_errors_grow_with_the_change_and_lean_from_quarter_to_quarter() -> None:
    scene, settings = zigzag(0.2), replace(DEFAULT_RIG, on_curves=LightError(0.0, 0.2))
    error = half_way(scene, settings)
    change = np.abs(np.diff(scene.taken, axis=0)).reshape(len(error), -1)
    assert not error[change == 0].any()
    unit = 0.2 * scene.surprise_by_change * scene.fall * change[change > 0]
    assert np.median(np.abs(error[change > 0]) / unit) == pytest.approx(0.765, rel=0.02)
    first, third = (np.clip(half_way(scene, settings, way)[change > 0] / unit, -9, 9) for way in (0.25, 0.75))
    assert 0.1 < np.corrcoef(first, third)[0, 1] < 0.35  # 0.22 where no draw is large


def test_guessed_light_is_known_where_it_goes_straight_and_nothing_surprises_before_or_after() -> None:
    """Along a curve it is known wherever nothing surprises."""
    taken, t_us = frames()
    taken[9, 2, 2] += 20  # a surprise, in what stands still
    curve, none = scene_of(taken, t_us, "cubic"), np.empty(0, EVENT)
    assert (known_light(curve, none).gaps == curve.trusted(curve.tolerance)).all()
    images = curve.images.copy()
    images[np.searchsorted(curve.t_us, 30_000) + 1, 6, 1] += 10
    guessed = replace(curve, images=images, how="auto")
    known, trusted = (gaps.reshape(-1, 8, 8) for gaps in (known_light(guessed, none).gaps, guessed.trusted()))
    assert not known[3, 6, 1]  # it leaves the straight line by 10 of 62 DN
    assert known[2, 6, 1]
    assert known[4, 6, 1]
    changes = np.flatnonzero(~trusted[:, 2, 2])
    assert np.flatnonzero(~known[:, 2, 2]).tolist() == [changes[0] - 1, *changes, changes[-1] + 1]


@pytest.mark.parametrize(("on", "off", "tolerance"), [
    (400, 400, 0.05), (5000, 300, 0.2), (300, 5000, 0.2), (40, 5000, 0.2), (40, 20, 0.2),
])  # fmt: skip
def test_guessed_light_is_trusted_farther_where_events_of_a_polarity_are_few(
    on: int, off: int, tolerance: float
) -> None:
    """Four hundred are enough, or half of all. As many come on the left, where nothing surprises, and three
    times as many on the right, where frames surprise by more than 10 %."""
    t_us = np.arange(20) * 10_000
    taken = np.full((20, 8, 8), 100.0, np.float32)
    taken[1::2, :, 4:] = 114
    curve = scene_of(taken, t_us, "cubic")
    scene = replace(curve, images=taken, t_us=t_us, how="auto")
    events = np.zeros(4 * (on + off), EVENT)
    events["t"], events["x"] = 55_000, 6
    events["p"][: 4 * on] = True
    events["x"][: 4 * on : 4] = events["x"][4 * on :: 4] = 1
    assert (known_light(scene, events).gaps == scene.known(tolerance).all_around().gaps).all()
    left = events[events["x"] == 1]  # all of these in light that is known anyway
    assert (known_light(scene, left).gaps == scene.known(0.05).all_around().gaps).all()
    assert not scene.trusted(0.1).all()
    assert scene.trusted(0.2).all()


def test_what_rounding_hides_is_in_each_version_and_in_none_on_average() -> None:
    taken, t_us = frames()
    rounding = np.random.default_rng(1).uniform(-0.4, 0.4, (2, *taken.shape)).astype(np.float16)
    scene = scene_of(taken, t_us, "spline")
    told = scene.with_rounding(rounding)
    versions = []
    for k in range(4):
        shown = {t: image for image, t in light_behind(told, k, DEFAULT_RIG)}
        versions.append(np.stack([shown[t] for t in t_us.tolist()]) - taken)
    assert versions[0] == pytest.approx(rounding[0], abs=2e-3)
    assert versions[2] == pytest.approx(rounding[1], abs=2e-3)
    assert np.mean(versions, axis=0) == pytest.approx(np.zeros_like(taken), abs=1e-3)


def test_noisier_light_has_all_errors_larger_by_the_same() -> None:
    taken, t_us = frames()
    rounding = np.random.default_rng(1).uniform(-0.4, 0.4, (2, *taken.shape)).astype(np.float16)
    scene = scene_of(taken, t_us, "cubic").with_rounding(rounding)
    told, noisier = (
        np.stack([image for image, _ in light_behind(scene, 1, DEFAULT_RIG, noisier)]) - scene.images
        for noisier in (False, True)
    )
    assert noisier == pytest.approx(DEFAULT_RIG.noisier * told, abs=2e-3)
    assert np.abs(told).max() > 0.5
