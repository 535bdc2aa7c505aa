"""docs/how-to/add-a-statistic.md, followed to the letter on a copy of the repository."""

from pathlib import Path

from .follow import follow

REPORT = """
from tests.lab.diagnosis.made_rig import CATALOGUE, START, MadeRig, response
from voltcam_lab.battery import LABELS
from voltcam_lab.diagnosis.figures_battery import gap_by_group
from voltcam_lab.diagnosis.loop import diagnose
from voltcam_lab.diagnosis.model import Model
from voltcam_lab.diagnosis.where import gap_by_group as gaps, plain, ranked, views

rig = MadeRig()
data = response(START) + rig.noise(1)
found = diagnose(rig, data, Model(START), CATALOGUE, print)
[view] = views(rig, found, data).values()
own = [plain(LABELS[i]) for i in ranked(view, data).order() if LABELS[i].group == "K"]
print(len(own), own[0])
drawn = gap_by_group({"model": gaps(view, data)})
print([one.get_text() for one in drawn.axes[0].get_xticklabels()])
"""


def test_the_page_adds_a_statistic(tmp_path: Path) -> None:
    page = follow("how-to/add-a-statistic.md", tmp_path)
    [own_test] = page.commands
    assert "1 passed" in page.run(own_test)
    (tmp_path / "report.py").write_text(REPORT)
    *_, own, groups = page.run("PYTHONPATH=.:$PYTHONPATH python report.py").splitlines()
    assert own.startswith("8 next events: ")
    assert "'sequence'" in groups
