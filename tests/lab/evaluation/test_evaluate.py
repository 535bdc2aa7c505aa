"""A synthetic recording whose truth is known: the model that made it comes out closest."""

from dataclasses import replace
from functools import partial

import pytest

from voltcam_lab.distances import HEADLINES, MEASURES, held_out
from voltcam_lab.evaluation.evaluate import Evaluation, evaluate, yardstick_of
from voltcam_lab.health import Inspection, inspect
from voltcam_lab.models.model import MODELS
from voltcam_lab.recordings import Footage

from .conftest import HEIGHT, TRUTH, WIDTH

OTHER = TRUTH.changed({"contrast_response": {"k1": 9.0}, "leak_noise": {"k6": 5e-4}})


@pytest.fixture(scope="module")
def evaluation(inspection: Inspection) -> Evaluation:
    models = {
        name: partial(MODELS["exact"], WIDTH, HEIGHT, parameters, 5)
        for name, parameters in (("exact, other", OTHER), ("exact, truth", TRUTH))
    }
    steps: list[str] = []
    done = evaluate(inspection, models, name="Waves", upsampling="cubic", progress=steps.append)
    assert [step for step in steps if "distances" not in step][1:] == [*models, "lags", "real against real"]
    return done


def test_the_model_that_made_the_recording_is_closest(evaluation: Evaluation) -> None:
    truth, other = evaluation.rows["exact, truth"], evaluation.rows["exact, other"]
    for name in (*HEADLINES, "noise"):
        best = MEASURES[name].best
        assert best is not None
        assert abs(truth[name] - best) < abs(other[name] - best), name
    assert truth["W1"] < 3 * evaluation.floors["real, other pixels"]["W1"]
    assert truth["on"] == pytest.approx(
        evaluation.yardstick.figures(evaluation.recording.events)["on"], rel=0.1
    )
    assert all("exact, truth is closest" in line for line in evaluation.verdict())


def test_the_table_has_every_model_and_measure(evaluation: Evaluation) -> None:
    text = evaluation.to_markdown()
    for name in (*MEASURES, *evaluation.rows, *evaluation.floors):
        assert name in text
    assert "| lag [ms] | real | exact, other | exact, truth |" in text
    rows = [line for line in text.splitlines() if line.startswith("| exact, truth")]
    assert rows[0].count("**") >= 2 * len(HEADLINES)  # the closest is set in bold
    assert len({line.count("|") for line in text.split("\n\n")[0].splitlines()}) == 1


def test_only_what_is_held_out_is_judged(evaluation: Evaluation, inspection: Inspection) -> None:
    fitting, judging = held_out(yardstick_of(inspection).region)
    region = evaluation.yardstick.region
    assert (region.pixels == judging.pixels).all()
    assert not (region.pixels & fitting.pixels).any()


def test_a_recording_that_compares_nothing_is_refused(recording: Footage) -> None:
    with pytest.raises(ValueError, match="has 9 frames"):
        yardstick_of(
            inspect(replace(recording, frames=recording.frames[:9], frame_t_us=recording.frame_t_us[:9]))
        )
    with pytest.raises(ValueError, match="3 events between"):
        yardstick_of(inspect(replace(recording, events=recording.events[:3])))
    late = recording.events.copy()
    late["t"] += 3_600_000_000
    with pytest.raises(ValueError, match="one clock"):
        yardstick_of(inspect(replace(recording, events=late)))
