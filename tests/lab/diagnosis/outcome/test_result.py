"""result.json and camera.yaml."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from pydantic import ValidationError

from voltcam_lab.diagnosis.outcome.accepted import Accepted, camera_of, fitted
from voltcam_lab.diagnosis.outcome.conclude import result_of
from voltcam_lab.diagnosis.outcome.result import Result, schema
from voltcam_simulator import Camera

from ..conftest import FEW_RUNS, Done

SCHEMA = Path(__file__).parents[4] / "docs" / "diagnosis.schema.json"


@pytest.fixture(scope="module")
def result(done: Done) -> Result:
    return result_of(done.session, done.search, done.identifiability, done.diagnosis)


def test_the_hidden_effect_is_named_with_its_size(result: Result) -> None:
    assert result.verdict == "effects"
    (effect,) = result.effects
    assert effect.name == "refractory_period"
    size = effect.parameters["period_us"]
    assert size.low < 6000 < size.high
    assert size.low < size.value < size.high
    assert effect.gap_before > effect.gap_after >= 0.5 * effect.gap_floor
    assert effect.p_value < 0.01
    assert result.gap.before == effect.gap_before
    assert result.gap.after == effect.gap_after
    assert "refractory period" in result.sentence


def test_the_seeds_are_those_of_the_runs_that_were_made(done: Done, result: Result) -> None:
    assert result.seeds.twins == list(FEW_RUNS.runs.twins)
    assert len(done.diagnosis.steps[-1].screen.spread.twins) == len(FEW_RUNS.runs.twins)


def test_what_was_taken_out_of_the_camera_file_is_said_last(done: Done) -> None:
    more = {"noise_pairs": {"rate_hz": 0.5}, "latency": {"delay_us": 2000}}
    given = done.session.camera.parameters.changed(more)
    session = replace(done.session, given=done.session.camera.model_copy(update={"parameters": given}))
    for way, end in (("fitted", "They are taken out."), ("found added", "They stay in the new file.")):
        file = Accepted(given, way, {})  # type: ignore[arg-type]
        result = result_of(session, done.search, done.identifiability, done.diagnosis, file=file)
        assert result.sentence.startswith("The camera file lacks refractory period")
        assert f"without these effects of the camera file: noise pairs, latency. {end}" in result.sentence
        assert set(result.settings.taken_out) == set(more)


def test_it_is_said_when_the_file_seems_to_be_of_another_camera(done: Done, result: Result) -> None:
    assert "another camera" not in result.sentence
    fitted = done.diagnosis.hypothesis
    far = replace(done.diagnosis, hypothesis=replace(fitted, shift=(0.5, 0, 0, 0, -2.3, *fitted.shift[5:])))
    sentence = result_of(done.session, done.search, done.identifiability, far).sentence
    assert "k5_per_dn_us is 0.1 times what the camera file says: is the file of another camera (" in sentence


def test_of_a_gap_without_a_name_it_is_said_what_comes_nearest(done: Done) -> None:
    open_end = replace(done.diagnosis, verdict="unknown", found=())
    result = result_of(done.session, done.search, done.identifiability, open_end).sentence
    assert result.startswith("Something is missing, and nothing in the catalogue explains it")
    nearest = done.diagnosis.steps[0].trials[0]
    assert f"Refractory period comes nearest, and leaves {nearest.held_out:.2f}." in result


def test_strata_are_ranked_and_their_intervals_hold_the_effect(result: Result) -> None:
    z = [abs(one.z) for one in result.where]
    assert z == sorted(z, reverse=True)
    assert max(abs(one.z) for one in result.where_after) < z[0]
    for one in result.where:
        assert one.effect.low <= one.effect.value <= one.effect.high
        assert (one.effect.value > 0) == (one.z > 0)
        if one.unit == "share":
            assert one.effect.low >= -1
    intervals = [one for one in result.where if one.group == "B" and "interval" in one.strata]
    holes = [one for one in intervals if one.strata["interval"] in ("2 to 5 ms", "5 to 10 ms")]
    clear = {one.strata["polarity"] for one in holes if one.strata["interval"] == "5 to 10 ms"}
    assert clear == {"ON", "OFF"}
    assert all(one.effect.value < -0.5 for one in holes)


def test_counts_are_numbers_of_events(done: Done, result: Result) -> None:
    measured = {one.statistic + str(one.strata): one.measured for one in result.where if one.unit == "share"}
    assert measured
    assert all(abs(number - round(number)) < 1e-6 for number in measured.values())


def test_json_is_read_back_as_it_was(result: Result) -> None:
    text = result.model_dump_json()
    assert Result.model_validate_json(text) == result
    with pytest.raises(ValidationError, match="verdict"):
        Result.model_validate({**json.loads(text), "verdict": "maybe"})
    with pytest.raises(ValidationError, match="surprise"):
        Result.model_validate({**json.loads(text), "surprise": 1})


def test_the_schema_in_docs_is_the_code_s() -> None:
    assert json.loads(SCHEMA.read_text()) == schema(), "write diagnosis.result.schema() to it as JSON"


def test_the_camera_file_loads_and_has_the_effect(done: Done, result: Result, tmp_path: Path) -> None:
    path = tmp_path / "camera.yaml"
    path.write_text(camera_of(done.session, fitted(done.diagnosis)).to_yaml())
    camera = Camera.load(path)
    assert (camera.width, camera.height) == (32, 24)
    value = result.effects[0].parameters["period_us"].value
    assert camera.parameters.refractory_period.period_us == pytest.approx(value)
    assert camera.parameters == done.diagnosis.hypothesis.parameters()


def test_the_runs_that_were_made_are_listed(done: Done, result: Result) -> None:
    runs = FEW_RUNS.runs
    assert result.seeds.twins == list(runs.twins)
    assert len(done.diagnosis.steps[0].screen.spread.twins) == len(runs.twins) == 8
    assert result.seeds.signatures == list(runs.signatures)
    assert result.seeds.fitting == list(runs.fitting)
