"""docs/how-to/add-a-statistic.md, followed to the letter on a copy of the repository."""

from pathlib import Path

from .follow import follow

REPORT = """
from tests.lab.diagnosis.made_rig import CATALOGUE, START, MadeRig, response
from voltcam_lab.statistics import LABELS
from voltcam_lab.diagnosis.outcome.figures_statistics import group_gap_bars
from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.loop import diagnose
from voltcam_lab.diagnosis.search.state import Search
from voltcam_lab.diagnosis.outcome.where import gaps_by_group, label_in_words, ranked, views

rig = MadeRig()
data = response(START) + rig.noise(1)
search = Search(rig, data, CATALOGUE, say=print)
found = diagnose(search, Hypothesis(START))
[view] = views(search, found).values()
own = [label_in_words(LABELS[i]) for i in ranked(view, data).order() if LABELS[i].group == "M"]
print(len(own), own[0])
drawn = group_gap_bars({"model": gaps_by_group(view, data)})
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
