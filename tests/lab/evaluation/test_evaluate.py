"""A synthetic recording whose truth is known: the model that made it comes out closest."""

from argparse import ArgumentParser
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from voltcam_client.formats import open_writer
from voltcam_lab.distances import HEADLINES, MEASURES, held_out
from voltcam_lab.evaluation import cli as cli_evaluate
from voltcam_lab.evaluation import contenders
from voltcam_lab.evaluation.evaluate import Evaluation, evaluate, yardstick_of
from voltcam_lab.health import Inspection, inspect
from voltcam_lab.light.scene import scene_of
from voltcam_lab.models.model import MODELS, simulate
from voltcam_lab.recordings import Footage
from voltcam_simulator import Parameters

WIDTH, HEIGHT, FRAMES, PERIOD_US = 144, 96, 81, 20_000
TRUTH = Parameters.of("paper").changed({"comparator": {"theta_on": 1.3, "theta_off": 0.8}})
OTHER = TRUTH.changed({"contrast_response": {"k1": 9.0}, "leak_noise": {"k6": 5e-4}})


@pytest.fixture(scope="module")
def recording() -> Footage:
    """Waves that move on the left, while the right third is held; 50 fps, 1.6 s."""
    y, x = np.indices((HEIGHT, WIDTH), dtype=np.float64)
    times = np.arange(FRAMES) * PERIOD_US
    moving = x < 2 * WIDTH / 3
    frames = np.stack([
        np.where(moving, 90 + 70 * np.sin((x + y / 2 - 25e-6 * t) / 5), 60 + x / 3) for t in times
    ]).astype(np.uint8)  # fmt: skip
    t_us = times.astype(np.int64)
    events = simulate(MODELS["exact"](WIDTH, HEIGHT, TRUTH, 11), scene_of(frames, t_us, "cubic"))
    return Footage(events, WIDTH, HEIGHT, frames, t_us)


@pytest.fixture(scope="module")
def inspection(recording: Footage) -> Inspection:
    return inspect(recording)


@pytest.fixture(scope="module")
def evaluation(inspection: Inspection) -> Evaluation:
    models = {
        name: partial(MODELS["exact"], WIDTH, HEIGHT, parameters, 5)
        for name, parameters in (("exact, other", OTHER), ("exact, truth", TRUTH))
    }
    steps: list[str] = []
    done = evaluate(inspection, models, name="Waves", upsampling="cubic", progress=steps.append)
    assert [step for step in steps if "distances" not in step][1:] == [*models, "real against real"]
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


def test_fits_see_nothing_of_what_is_judged(inspection: Inspection, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: dict[str, Any] = {}

    def reading(*given: object) -> object:
        seen["reading"] = given
        raise ValueError("enough")

    monkeypatch.setattr(contenders, "Reading", reading)
    fitting, judging = held_out(yardstick_of(inspection).region)
    with pytest.raises(ValueError, match="enough"):
        contenders.contenders(inspection, fitting)
    *_, keep, masked = seen["reading"]
    assert not (keep & judging.pixels).any()
    for begin, end in judging.times.tolist():
        assert any(first <= begin and end <= last for first, last in masked.windows.tolist())


def test_the_command_writes_the_page_and_its_figures(
    recording: Footage, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with open_writer(tmp_path / "waves.npz", width=WIDTH, height=HEIGHT) as writer:
        writer.events(recording.events)
        for frame, t_us in zip(recording.frames, recording.frame_t_us, strict=True):
            writer.frame(frame, int(t_us))

    def found(_: Inspection, *__: object) -> object:
        models = {"exact": partial(MODELS["exact"], WIDTH, HEIGHT, TRUTH, 5)}
        return scene_of(recording.frames, recording.frame_t_us, "cubic"), models, ["esim: no"]

    monkeypatch.setattr(cli_evaluate, "contenders", found)
    parser = ArgumentParser()
    cli_evaluate.configure(parser)
    arguments = parser.parse_args([str(tmp_path / "waves.npz"), "--out", str(tmp_path / "docs")])
    assert arguments.run(arguments) == 0
    assert "W1: exact is closest" in capsys.readouterr().out
    text = (tmp_path / "docs" / "evaluation.md").read_text(encoding="utf-8")
    assert "waves: esim: no" in text
    assert "| exact |" in text
    images = [part.split(")")[0] for part in text.split("](")[1:]]
    assert len(images) == 7
    for image in images:
        content = (tmp_path / "docs" / image).read_bytes()
        assert content.startswith(b"\x89PNG")
        assert len(content) < 300_000
