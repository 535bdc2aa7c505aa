"""What results of campaigns depend on."""

from pathlib import Path

from .results import digest, sources, whole_lines

ROOT = Path(__file__).parents[1]


def names(module: str) -> set[str]:
    return {file.relative_to(ROOT).as_posix() for file in sources(module)}


def test_a_grid_depends_on_what_it_calls() -> None:
    grid, pairs = names("tests.hidden_effects.run"), names("tests.pairs_study.run")
    lab = "simulator/voltcam_lab"
    for called in ("simulator/voltcam_simulator/simulator.py", "tests/generator/__init__.py"):
        assert called in grid & pairs
    assert f"{lab}/diagnosis/search/loop.py" in grid - pairs
    assert f"{lab}/calibration/camera_from.py" in pairs - grid
    assert not any(name.startswith((f"{lab}/evaluation/", f"{lab}/pages/")) for name in grid | pairs)
    assert digest("tests.hidden_effects.run") != digest("tests.pairs_study.run")


def test_a_line_that_was_cut_off_is_removed(tmp_path: Path) -> None:
    file = tmp_path / "results.jsonl"
    assert whole_lines(file) == []
    file.write_bytes(b"{1}\n{2}\n{3")
    assert whole_lines(file) == [b"{1}", b"{2}"]
    assert file.read_bytes() == b"{1}\n{2}\n"
