"""From a recording to a camera file: what is refused, what is looked at, and what the file says.

The fit itself is another module's: here it finds what it is told to find.
"""

from dataclasses import replace

import numpy as np
import pytest
import yaml
from tests.lab.health.made import (
    HEIGHT,
    WIDTH,
    frame_locked,
    healthy,
    some_events,
    well,
    with_events,
)
from threadpoolctl import threadpool_info, threadpool_limits

from voltcam_lab.calibration import camera_from as module
from voltcam_lab.calibration import exact_method, part
from voltcam_lab.calibration.calibrate import Calibration, CalibrationError
from voltcam_lab.calibration.calibrated import Calibrated
from voltcam_lab.calibration.camera_from import camera_from
from voltcam_lab.calibration.estimates import correlations, estimates_of, noise_shares
from voltcam_lab.calibration.fit import PRIOR, Fit
from voltcam_lab.calibration.reading import Reading
from voltcam_lab.calibration.refine.refinement import Refined, Refinement
from voltcam_lab.distances import Region
from voltcam_lab.health import inspect
from voltcam_lab.light.scene import Scene, scene_of
from voltcam_lab.windows import within
from voltcam_simulator import Camera, Parameters
from voltcam_simulator.camera_file import intervals_of
from voltcam_simulator.effects.junction_leak import arrhenius

FOUND = Parameters.of("ideal").changed({
    "contrast_response": {"k1": 6.123456, "k2_dn": 21.0}, "junction_leak": {"k4_per_us": 2e-7},
})  # fmt: skip


def told(reading: Reading, *_: object) -> Calibration:
    """What a fit might have found, whatever the recording."""
    k = len(PRIOR.centre)
    covariance = np.diag((0.3 * PRIOR.sd) ** 2)
    fit = Fit(PRIOR.centre, covariance, 0.3 * PRIOR.sd, np.eye(k), 0.97, (0.0, 0.0), 0.0)
    noise = noise_shares(PRIOR.centre, covariance)
    return Calibration(
        FOUND, estimates_of(PRIOR.centre, 0.3 * PRIOR.sd, noise), correlations(covariance, noise), -250.0,
        0.0, fit, reading, 4321,
    )  # fmt: skip


def straight(frames: np.ndarray, t_us: np.ndarray) -> Scene:
    """The light between frames goes straight: soonest made."""
    return scene_of(frames, t_us, "linear")


def as_it_was(_: Refinement, start: Parameters) -> Parameters:
    """In place of a step."""
    return start


@pytest.fixture(autouse=True)
def _no_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exact_method, "calibrate", told)
    monkeypatch.setattr(module, "scene_between", straight)


@pytest.fixture(scope="module")
def plain() -> Calibrated:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(exact_method, "calibrate", told)
        patch.setattr(module, "scene_between", straight)
        return camera_from(well(), name="mine", refining=False)


def test_the_camera_has_what_was_found_and_the_recording_s_size(plain: Calibrated) -> None:
    assert (plain.camera.name, plain.camera.width, plain.camera.height) == ("mine", WIDTH, HEIGHT)
    assert plain.camera.parameters.contrast_response == FOUND.contrast_response
    assert plain.refined is None
    assert plain.moved == ()


def test_the_same_is_found_on_any_number_of_cores() -> None:
    """Sums of several threads are in another order, and end in another maximum of the likelihood."""
    seen: list[int] = []
    with threadpool_limits(2, user_api="blas"):
        camera_from(
            well(), refining=False,
            report=lambda step: seen.extend(one["num_threads"] for one in threadpool_info()),
        )  # fmt: skip
        assert set(seen) == {1}
        assert 2 in {one["num_threads"] for one in threadpool_info()}  # and as it was behind


def test_notes_say_what_was_fitted_and_what_may_be_wrong(plain: Calibrated) -> None:
    text = "\n".join(plain.notes)
    for words in (
        "160 frames", "4321 intervals", "97% of these", "k1 and k2_dn are correlated",
    ):  # fmt: skip
        assert words in text


def test_the_file_loads_as_the_camera_to_four_digits(plain: Calibrated) -> None:
    text = plain.to_yaml("walk.npz")
    assert text.startswith("# Calibrated by `voltcam calibrate` (exact law) from walk.npz.")
    comments = [line for line in text.splitlines() if line.startswith("#")]
    assert all(any(note in line for line in comments) for note in plain.notes)
    loaded = yaml.safe_load(text)
    assert set(intervals_of(loaded)) == {f"{one.effect}.{one.parameter}" for one in plain.estimates}
    assert Camera.from_mapping(loaded).parameters.contrast_response.k1 == 6.123
    assert loaded["contrast_response"]["k1"] == 6.123
    assert (loaded["name"], loaded["width"], loaded["height"]) == ("mine", WIDTH, HEIGHT)
    assert "parameters" not in loaded


def test_the_leak_is_given_at_its_own_temperature() -> None:
    """Fitted at 45 degrees, it is that much less at the one that a file gives it for."""
    found = camera_from(well(), temperature_c=45.0, refining=False).camera.parameters
    assert found.temperature_c == 45
    at_45 = found.junction_leak.k4_per_us * arrhenius(45.0, found.junction_leak.activation_energy_ev)
    assert at_45 == pytest.approx(2e-7)
    assert found.junction_leak.k4_per_us < 2e-7


def test_other_effects_of_a_base_are_kept_and_its_size_must_fit() -> None:
    base = Camera(name="base", width=WIDTH, height=HEIGHT, parameters=Parameters().changed({
        "latency": {"jitter_us": 33.0}, "contrast_response": {"k1": 1.0},
    }))  # fmt: skip
    found = camera_from(well(), base=base, refining=False).camera.parameters
    assert found.latency.jitter_us == 33
    assert found.contrast_response.k1 == FOUND.contrast_response.k1
    with pytest.raises(CalibrationError, match=f"base has 3x2 pixels, the recording {WIDTH}x{HEIGHT}"):
        camera_from(well(), base=base.model_copy(update={"width": 3, "height": 2}))


def test_hot_pixels_are_counted_and_not_fitted() -> None:
    """One that fires 100 times a second for the whole 4 s, at random."""
    t_us = int(healthy().frame_t_us[0]) + np.random.default_rng(1).integers(0, 4_000_000, 400)
    hot = inspect(with_events(healthy(), some_events(t_us, 20, 30, True)))
    assert np.argwhere(hot.hot).tolist() == [[30, 20]]
    found = camera_from(hot, refining=False)
    assert not found.reading.keep[30, 20]
    assert found.reading.keep.sum() == WIDTH * HEIGHT - 1
    parameters = found.camera.parameters.hot_pixels
    assert parameters.fraction == pytest.approx(1 / (WIDTH * HEIGHT))
    assert parameters.rate_hz == pytest.approx(100, rel=0.05)


def test_of_too_much_the_middle_is_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    recording = healthy()
    monkeypatch.setattr(part, "MOST_SAMPLES", recording.frames.size // 4)
    found = camera_from(well(), refining=False)
    scene = found.reading.scene
    assert (scene.height, scene.width) == (HEIGHT // 2, WIDTH // 2)
    top, left = HEIGHT // 4, WIDTH // 4
    np.testing.assert_array_equal(
        scene.taken, recording.frames[:, top : top + HEIGHT // 2, left : left + WIDTH // 2]
    )
    inside = [
        (t, x - left, y - top, p)
        for t, x, y, p in recording.events.tolist()
        if top <= y < top + HEIGHT // 2 and left <= x < left + WIDTH // 2
    ]
    assert found.reading.events.tolist() == inside
    assert f"of the middle {WIDTH // 2}x{HEIGHT // 2} pixels of {WIDTH}x{HEIGHT}" in found.notes[0]
    assert (found.camera.width, found.camera.height) == (WIDTH, HEIGHT)


@pytest.mark.parametrize("taken", [True, False])
def test_what_behaves_more_alike_to_pixels_that_saw_no_step_is_taken(
    monkeypatch: pytest.MonkeyPatch, taken: bool
) -> None:
    better = FOUND.changed({"contrast_response": {"k1": 7.0}, "latency": {"delay_us": 900.0}})

    def refined(refinement: Refinement, _: Parameters, same_light: bool) -> Refined:
        assert same_light
        return Refined(better, refinement.scene, "as it was", (), (), 1.0, 0.9, taken)

    def settled(_: Refinement, start: Parameters) -> Parameters:
        asked.append(start)
        return start

    asked: list[Parameters] = []
    monkeypatch.setattr(Refinement, "refined", refined)
    monkeypatch.setattr(Refinement, "settled", settled)
    found = camera_from(well())
    assert bool(asked) == taken
    moved = {name: (before, now) for name, before, now in found.moved}
    assert bool(moved) == taken
    if taken:
        assert moved["contrast_response.k1"] == (6.123456, 7.0)
        assert set(moved) <= {"contrast_response.k1", "latency.delay_us"}
    for name, (_, now) in moved.items():  # as it is in the file
        effect, parameter = name.split(".")
        assert getattr(getattr(found.camera.parameters, effect), parameter) == now
    assert found.camera.parameters.contrast_response.k1 == (7.0 if taken else 6.123456)
    said = "were moved to behave as the recording does" if taken else "are the likeliest"
    assert any(said in note for note in found.notes)
    for one in found.estimates:  # a file does not contradict the intervals printed with it
        value = getattr(getattr(found.camera.parameters, one.effect), one.parameter)
        assert one.low <= value <= one.high


@pytest.mark.parametrize("taken", [True, False])
def test_what_the_ends_of_the_scale_stand_for_stays_whether_the_rest_is_moved_or_not(
    monkeypatch: pytest.MonkeyPatch, taken: bool
) -> None:
    better = FOUND.changed({"contrast_response": {"k1": 7.0}})
    begun: list[Parameters] = []

    def refined(refinement: Refinement, _: Parameters, **__: object) -> Refined:
        return Refined(better, refinement.scene, "as it was", (), (), 1.0, 0.9, taken)

    def black(_: Refinement, start: Parameters) -> Parameters:
        begun.append(start)
        return start.changed({"input_response": {"pedestal_dn": 5.0}})

    monkeypatch.setattr(Refinement, "refined", refined)
    monkeypatch.setattr(Refinement, "with_ends", black)
    monkeypatch.setattr(Refinement, "settled", as_it_was)
    found = camera_from(well())
    assert begun[0].contrast_response.k1 == (7.0 if taken else 6.123456)
    assert found.camera.parameters.input_response.pedestal_dn == 5.0
    assert ("input_response.pedestal_dn", 0.0, 5.0) in found.moved


@pytest.mark.parametrize(("share", "moved"), [(0.45, False), (0.55, True)])
def test_nothing_is_moved_by_light_that_is_mostly_unknown(
    monkeypatch: pytest.MonkeyPatch, share: float, moved: bool
) -> None:
    def refined(refinement: Refinement, _: Parameters, **__: object) -> Refined:
        better = FOUND.changed({"contrast_response": {"k1": 7.0}})
        return Refined(better, refinement.scene, "as it was", (), (), 1.0, 0.5, True)

    monkeypatch.setattr(Refinement, "refined", refined)
    monkeypatch.setattr(exact_method, "known_share", lambda *_: share)
    monkeypatch.setattr(Refinement, "settled", as_it_was)
    found = camera_from(well())
    assert found.camera.parameters.contrast_response.k1 == (7.0 if moved else 6.123456)
    assert (found.refined is not None) == moved
    assert any("45% of the events come where light" in note for note in found.notes) != moved


@pytest.mark.parametrize("kick", [0.1, 0.0])
def test_events_about_exposures_count_where_the_camera_has_what_makes_them(
    monkeypatch: pytest.MonkeyPatch, kick: float
) -> None:
    """And what frames do is fitted again to the pixels that come of it."""
    inspection = inspect(frame_locked(rows_us=0))
    pixels: list[Parameters] = []
    regions: list[Region] = []

    def with_frames(
        _: object, __: object, ___: object, own: Parameters, *____: object
    ) -> tuple[Parameters, None]:
        pixels.append(own)
        return own.changed({"aps_coupling": {"exposure_kick": kick}}), None

    def refined(refinement: Refinement, start: Parameters, **_: object) -> Refined:
        regions.append(refinement.fitting)
        better = start.changed({"contrast_response": {"k1": 7.0}})
        return Refined(better, refinement.scene, "", (), (), 1.0, 0.5, True)

    monkeypatch.setattr(exact_method, "with_frames_of", with_frames)
    monkeypatch.setattr(Refinement, "refined", refined)
    monkeypatch.setattr(Refinement, "settled", as_it_was)
    found = camera_from(inspection).camera.parameters
    (region,) = regions
    middle_us = inspection.exposure_windows.mean(axis=1)[1:-1]
    assert set(within(middle_us, region.live).tolist()) == {kick > 0}
    assert [own.contrast_response.k1 for own in pixels] == [6.123456, 7.0]
    assert not any(own.aps_coupling.active for own in pixels)
    assert (found.contrast_response.k1, found.aps_coupling.exposure_kick) == (7.0, kick)


def test_a_recording_of_no_use_is_refused_with_its_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    broken = inspect(replace(healthy(), events=healthy().events[:0]))
    with pytest.raises(CalibrationError, match="no events"):
        camera_from(broken)

    def refused(*_: object) -> None:
        raise ValueError("too few intervals")

    monkeypatch.setattr(module, "calibrate_as_paper", refused)
    with pytest.raises(CalibrationError, match="too few intervals"):
        camera_from(well(), method="paper")
