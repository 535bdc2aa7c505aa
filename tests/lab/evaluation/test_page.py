"""The page of an evaluation whose distances are written down."""

from functools import partial
from pathlib import Path

import numpy as np
import pytest

from voltcam_lab.distances import DISTANCES, HEADLINES, MEASURES
from voltcam_lab.evaluation import page
from voltcam_lab.evaluation.bars import OURS
from voltcam_lab.evaluation.evaluate import Evaluation, yardstick_of
from voltcam_lab.evaluation.figures.noise import HeldImage
from voltcam_lab.evaluation.figures.temperature import LeakByTemperature
from voltcam_lab.health import Inspection

ROW = dict(zip(MEASURES, np.linspace(0.1, 0.9, len(MEASURES)), strict=True))


@pytest.fixture(autouse=True)
def _small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Held images of a few pixels, and empty files: what is on them is not this page's."""
    monkeypatch.setattr(page, "HeldImage", partial(HeldImage, 4, 10, 1.0))
    few = partial(LeakByTemperature, side=8, seconds=2, temperatures_c=(20, 60))
    monkeypatch.setattr(page, "LeakByTemperature", few)
    monkeypatch.setattr(page, "save", lambda _, path: path.write_bytes(b""))


def written(inspection: Inspection, out: Path, name: str, *notes: str) -> str:
    events = inspection.footage.events
    done = Evaluation(
        name, inspection.footage, yardstick_of(inspection), {OURS: ROW, "esim": ROW},
        {"real, other pixels": dict.fromkeys(DISTANCES, 0.01)}, {OURS: events, "esim": events[::2]},
    )  # fmt: skip
    path = page.write_evaluation([done], out, notes)
    assert path == out / "evaluation.md"
    return path.read_text(encoding="utf-8")


def test_the_page_has_each_measure_its_figures_and_the_notes(inspection: Inspection, tmp_path: Path) -> None:
    text = written(inspection, tmp_path, "My Waves (2)", "esim: no", "v2e: slow")
    for measure in MEASURES.values():
        assert f"- **{measure.name}**: {measure.title} [{measure.unit}]" in text
    assert "b4**: 4x4-block counts in 50 ms: correlation [1]; 1 is best" in text
    assert f"{inspection.footage.events.size} events; judged by " in text
    assert "- esim: no.\n- v2e: slow.\n" in text
    named = {part.split(")")[0] for part in text.split("](")[1:]}
    assert named == {f"evaluation/{one.name}" for one in (tmp_path / "evaluation").iterdir()}
    assert "evaluation/my-waves-2-clouds.png" in named
    assert len(named) == 5 + 2


def test_bars_stand_under_the_recordings_that_have_them(inspection: Inspection, tmp_path: Path) -> None:
    line = "| | best published, in-sample | bar |"
    known = written(inspection, tmp_path / "known", "slider_depth")
    assert line in known
    assert all(f"| {name} | " in known.split(line)[1] for name in HEADLINES)
    assert "## How models were fitted" not in known
    assert line not in written(inspection, tmp_path / "other", "waves")
