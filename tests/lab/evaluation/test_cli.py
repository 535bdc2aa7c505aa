"""`voltcam evaluate`: the page and its figures."""

from argparse import ArgumentParser
from functools import partial
from pathlib import Path

import pytest

from voltcam_client.formats import open_writer
from voltcam_lab.evaluation import cli as cli_evaluate
from voltcam_lab.evaluation import page
from voltcam_lab.evaluation.figures.noise import HeldImage
from voltcam_lab.health import Inspection
from voltcam_lab.light.scene import scene_of
from voltcam_lab.models.model import MODELS
from voltcam_lab.recordings import Footage

from .conftest import HEIGHT, TRUTH, WIDTH


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

    def later(_: Inspection, name: str, *__: object) -> object:
        raise ValueError(f"{name} has too few frames")

    monkeypatch.setattr(cli_evaluate, "contenders", found)
    monkeypatch.setattr(cli_evaluate, "later_part", later)
    monkeypatch.setattr(page, "HeldImage", partial(HeldImage, 16, 48, 4.0))
    parser = ArgumentParser()
    cli_evaluate.configure(parser)
    arguments = parser.parse_args([str(tmp_path / "waves.npz"), "--out", str(tmp_path / "docs")])
    assert arguments.run(arguments) == 0
    said = capsys.readouterr()
    assert "W1: exact is closest" in said.out
    assert "s: waves: distances of exact\n" in said.err
    text = (tmp_path / "docs" / "evaluation.md").read_text(encoding="utf-8")
    assert "waves: esim: no" in text
    assert "the later part was not judged: waves has too few frames" in text
    assert "| exact |" in text
    images = [part.split(")")[0] for part in text.split("](")[1:]]
    assert len(images) == 7
    for image in images:
        content = (tmp_path / "docs" / image).read_bytes()
        assert content.startswith(b"\x89PNG")
        assert len(content) < 300_000
