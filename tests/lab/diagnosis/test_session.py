"""Recordings made ready, good and bad; runs that are kept."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from voltcam_lab.diagnosis.rig.settings import DEFAULT_RECORDING, RecordingSettings
from voltcam_lab.diagnosis.session import DiagnosisError, session_of
from voltcam_lab.health import inspect
from voltcam_lab.recordings import Footage, load
from voltcam_simulator import EVENT, Camera

DATA = Path(os.environ.get("VOLTCAM_DATA", Path(__file__).parents[4] / "shared" / "data"))
SEEDS = [1, 2]
PAPER = Camera.load("paper")


def refused(recording: Footage, folder: Path, settings: RecordingSettings = DEFAULT_RECORDING) -> str:
    with pytest.raises(DiagnosisError) as caught:
        session_of(inspect(recording), PAPER, folder, name="bad.npz", settings=settings)
    text = str(caught.value)
    assert "\n" not in text
    assert "bad.npz" in text
    assert not list(folder.glob("*"))
    return text


def test_what_a_recording_lacks_is_said_in_a_line(tiny: Footage, tmp_path: Path) -> None:
    few = replace(tiny, frames=tiny.frames[:3], frame_t_us=tiny.frame_t_us[:3])
    assert "only 3 frames" in refused(few, tmp_path)
    assert "events" in refused(replace(tiny, events=np.empty(0, EVENT)), tmp_path)
    assert "fewer than 10 frames" in refused(tiny, tmp_path, RecordingSettings(seconds=0.01))
    refused(replace(tiny, frames=np.zeros_like(tiny.frames)), tmp_path)


def late(recording: Footage, by_us: int) -> Footage:
    events = recording.events.copy()
    events["t"] += by_us
    return replace(recording, events=events)


@pytest.mark.parametrize("by_us", [3_600_000_000, 200_000])
def test_events_of_another_clock_are_refused(tiny: Footage, tmp_path: Path, by_us: int) -> None:
    refused(late(tiny, by_us), tmp_path)


def test_events_that_may_have_queued_are_looked_at(tiny: Footage, tmp_path: Path) -> None:
    session = session_of(inspect(late(tiny, 60_000)), PAPER, tmp_path)
    assert session.health["clock"].severity == "fatal"
    assert session.data.any()


def test_light_that_is_known_nowhere_tells_nothing(tiny: Footage, tmp_path: Path) -> None:
    """Each frame is another picture: between them there may have been anything."""
    noise = np.random.default_rng(1).integers(0, 255, (40, *tiny.frames.shape[1:]), np.uint8)
    other = replace(tiny, frames=noise, frame_t_us=np.arange(40) * 50_000)
    assert "events 0 are where the light between frames is known" in refused_after(other, tmp_path)


def test_of_a_street_pixels_at_rest_are_enough(tmp_path: Path) -> None:
    """Its light is known nearly everywhere, but not where most events are."""
    path = DATA / "davis346_street" / "davis346.aedat4"
    if not path.exists():
        pytest.skip("no davis346_street in ../shared/data or $VOLTCAM_DATA")
    words = session_of(inspect(load(path)), PAPER, tmp_path).looked_at()
    assert "is known for 96% of pixels and time, with 1.3% of the events" in words


def refused_after(recording: Footage, folder: Path) -> str:
    with pytest.raises(DiagnosisError) as caught:
        session_of(inspect(recording), PAPER, folder, name="bad.npz")
    return str(caught.value)


def test_a_session_has_the_recording_s_size_and_looks_at_all_of_a_small_sensor(
    tiny: Footage, tmp_path: Path
) -> None:
    session = session_of(inspect(tiny), PAPER, tmp_path)
    assert (session.camera.width, session.camera.height) == (32, 24)
    assert session.columns.tolist() == list(range(32))
    assert session.seconds == pytest.approx(2.0, abs=0.01)
    assert "all 32 x 24 pixels" in session.looked_at()


def test_effects_of_the_camera_file_are_not_searched(tiny: Footage, tmp_path: Path) -> None:
    parameters = PAPER.parameters.changed({"refractory_period": {"period_us": 500}})
    session = session_of(inspect(tiny), PAPER.model_copy(update={"parameters": parameters}), tmp_path)
    assert "refractory_period" in session.left_out
    assert "refractory_period" not in {one.effect for one in session.candidates}
    assert "comparator" in {one.effect for one in session.candidates}


@pytest.mark.parametrize(
    ("in_file", "not_searched"),
    [
        ({"latency": {"jitter_us": 200}}, {("delay_us", "jitter_us")}),
        (
            {"aps_coupling": {"reset_kick": 0.05}},
            {
                ("exposure_kick",),
                ("readout_kick", "reset_kick"),
                ("exposure_kick", "readout_kick", "line_us"),
            },
        ),
    ],
)
def test_what_the_file_has_of_an_effect_is_not_written_over(
    tiny: Footage,
    tmp_path: Path,
    in_file: dict[str, dict[str, float]],
    not_searched: set[tuple[str, ...]],
) -> None:
    (effect,) = in_file
    camera = PAPER.model_copy(update={"parameters": PAPER.parameters.changed(in_file)})
    all_names, names = (
        {one.names for one in session_of(inspect(tiny), each, tmp_path).candidates if one.effect == effect}
        for each in (PAPER, camera)
    )
    assert all_names - names == not_searched


def test_what_is_in_step_with_the_recording_s_clock_is_found_and_written_on_it(
    tiny: Footage, tmp_path: Path
) -> None:
    late = 4_032_000
    events = tiny.events.copy()
    events["t"] += late
    later = replace(tiny, events=events, frame_t_us=tiny.frame_t_us + late)
    lit = PAPER.parameters.changed({"flicker": {"depth": 0.05, "phase_turns": 0.1}})
    camera = PAPER.model_copy(update={"parameters": lit})
    here, there = (session_of(inspect(one), camera, tmp_path) for one in (tiny, later))
    assert (here.origin_us, there.origin_us) == (0, late)
    assert here.parameters == lit
    turns = there.parameters.flicker.phase_turns
    assert turns == pytest.approx(0.3)  # 403.2 periods later


def test_of_a_large_sensor_strips_of_whole_columns_are_looked_at(tiny: Footage, tmp_path: Path) -> None:
    session = session_of(
        inspect(tiny), PAPER, tmp_path, settings=RecordingSettings(most_samples=401 * 24 * 16)
    )
    columns = session.columns
    assert len(columns) == 16
    assert session.rig.setting.scene.images.shape[1:] == (24, 16)
    mine = tiny.events[np.isin(tiny.events["x"], columns)]
    again = session.recording.events
    assert len(again) == np.count_nonzero(mine["t"] <= session.rig.setting.frame_t_us[-1])
    np.testing.assert_array_equal(columns[again["x"]], mine["x"][: len(again)])
    assert "vignetting" in session.left_out
    assert "16 of 32 columns" in session.looked_at()


def test_the_clock_of_the_recording_does_not_matter(tiny: Footage, tmp_path: Path) -> None:
    late, events = 394_137_685 * 4_032_000, tiny.events.copy()
    events["t"] += late
    later = replace(tiny, events=events, frame_t_us=tiny.frame_t_us + late)
    session, other = (session_of(inspect(one), PAPER, tmp_path) for one in (tiny, later))
    np.testing.assert_array_equal(session.data, other.data)
    assert session.candidates == other.candidates
    for one in other.candidates:
        one.on(PAPER.parameters, one.sizes[0])  # inside the limits
