"""The figures of a bench as JSON, and held against those of another run."""

from pathlib import Path

import pytest

from voltcam_server.bench.figure import Figure
from voltcam_server.bench.report import BenchReport
from voltcam_server.problems import UsageError


def report(*figures: Figure) -> BenchReport:
    return BenchReport.of(list(figures))


def test_a_report_is_read_as_it_was_written(tmp_path: Path) -> None:
    path, written = (
        tmp_path / "old.json",
        report(Figure.of("copy", [1.0, 2.0, 4.0], "GB/s"), Figure.of("sort", [2.0], "ns/event", "quiet")),
    )
    path.write_text(written.to_json())
    assert BenchReport.read(path) == written


def test_better_is_more_of_a_speed_and_less_of_a_time() -> None:
    old = report(
        Figure.of("speed", [10.0], "Mpx/s"), Figure.of("time", [10.0], "ms"), Figure.of("gone", [1.0], "s")
    )
    new = report(
        Figure.of("speed", [20.0], "Mpx/s"), Figure.of("time", [20.0], "ms"), Figure.of("new", [1.0], "s")
    )
    _, speed_line, time_line, *rest = new.against(old).splitlines()
    assert speed_line.endswith("2.00 times as good")
    assert time_line.endswith("0.50 times as good")
    assert rest == ["new: only in this run", "gone: only in the older run"]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "No such file"),
        ("[]", "no result of"),
        ("not JSON", "no result of"),
        ('{"format": 9', "no result of"),
    ],
)
def test_what_is_no_report_is_refused_in_a_line(tmp_path: Path, content: str | None, words: str) -> None:
    path = tmp_path / "old.json"
    if content is not None:
        path.write_text(content)
    with pytest.raises(UsageError, match=words) as refused:
        BenchReport.read(path)
    assert "voltcam bench --json" in str(refused.value)
    assert "\n" not in str(refused.value)


def test_another_format_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "old.json"
    path.write_text(report().to_json().replace('"format": 1', '"format": 2'))
    with pytest.raises(UsageError, match="is of format 2"):
        BenchReport.read(path)
