"""What `voltcam bench` measures, on a small scene and by a clock of the test's own."""

import argparse
import json
from collections.abc import Callable
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from voltcam_server import bench
from voltcam_server.bench import cost_per_event, speed, timed
from voltcam_server.bench_figure import Figure
from voltcam_server.bench_limits import MachineLimits
from voltcam_server.bench_report import BenchReport
from voltcam_server.bench_scene import moving, noisy
from voltcam_server.problems import UsageError
from voltcam_simulator import Parameters, Simulator

PAPER = Parameters.of("paper")
LIMITS = MachineLimits([Figure.of("copy", [1.0], "GB/s"), Figure.of("sort", [2.0], "ns/event")])


def ticking(step_s: float) -> Callable[[], float]:
    """A clock that is `step_s` further each time it is read."""
    ticks = count()
    return lambda: step_s * next(ticks)


def events_of(frames: np.ndarray, period_us: int, parameters: Parameters = PAPER) -> int:
    height, width = frames[0].shape
    simulator = Simulator(width, height, parameters, seed=1)
    return sum(simulator.advance(frame, period_us * i).size for i, frame in enumerate(frames))


def test_the_scene_is_the_one_that_others_were_measured_on() -> None:
    frames = moving(20, 346, 260)
    assert frames.shape == (20, 260, 346)
    assert 0.84 < (frames[1:] != frames[:-1]).mean() < 0.89
    assert 0.17 < events_of(frames, 4167) / frames[1:].size < 0.22


def test_the_webcam_has_noise_of_two_grey_levels() -> None:
    frames = noisy(50, 64, 48).astype(float)
    inside = (frames.mean(axis=0) > 20) & (frames.mean(axis=0) < 235)
    assert abs(frames.std(axis=0)[inside].mean() - 2) < 0.1


def test_a_figure_is_its_median_and_spread() -> None:
    assert str(Figure.of("sort", [3.0, 1.0, 2.0], "ns", "quiet")).split() == [
        "sort", "2", "1", "to", "3", "ns", "quiet",
    ]  # fmt: skip


def test_each_repeat_is_timed_and_events_are_of_one() -> None:
    frames = moving(6, 48, 36)
    seconds, events = timed(frames, 240, PAPER, clock=ticking(0.25))
    assert seconds == [0.25] * bench.REPEATS
    assert events == pytest.approx(events_of(frames, 4167), rel=0.2)  # each repeat draws numbers of its own


def test_speed_is_pixels_over_seconds_and_beside_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench, "timed", lambda *_: ([0.5, 1.0, 2.0], 4320.0))
    (figure,) = speed(LIMITS, "small", moving(6, 48, 36), 240, PAPER)
    pixels = 5 * 48 * 36
    assert (figure.median, figure.least, figure.most) == (pixels / 1e6, pixels / 2e6, pixels / 0.5e6)
    state_bytes = Simulator(48, 36, PAPER).state_bytes
    least_s = (5 * state_bytes + pixels) / 1e9 + 4320 * 2e-9
    assert figure.remark == f"0.500 events/pixel, {1 / least_s:.1f} times the limit"


def test_an_event_costs_the_difference_of_two_thresholds(monkeypatch: pytest.MonkeyPatch) -> None:
    def by_threshold(_frames: object, _fps: float, parameters: Parameters) -> tuple[list[float], float]:
        return ([3.0], 3e8) if parameters.comparator.theta_on == 1 else ([1.0], 1e8)

    monkeypatch.setattr(bench, "timed", by_threshold)
    assert cost_per_event(moving(2, 48, 36), PAPER)[0].median == pytest.approx(10)


def test_all_of_the_plan_is_measured_and_no_two_figures_have_one_name(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Small and once; `start`, which compiles everything anew, stays with the command."""
    monkeypatch.setattr(bench, "SIZES", {"40x30": (40, 30, 3)})
    monkeypatch.setattr(bench, "REPEATS", 1)
    monkeypatch.setattr(bench, "STILL_FRAMES", 4)
    monkeypatch.setattr(bench, "moving", lambda frames, *_: moving(min(frames, 17), 40, 30))
    monkeypatch.setattr(bench, "start", lambda: [Figure.of("start", [1.0], "s")])
    monkeypatch.setattr(MachineLimits, "measured", lambda: LIMITS)
    arguments: Any = argparse.Namespace(json=True, compare=None)
    assert bench.run(arguments) == 0
    printed = capsys.readouterr().out
    figures = json.loads(printed)["figures"]
    names = [figure["name"] for figure in figures]
    assert len(set(names)) == len(names) == 17
    assert all(np.isfinite(figure["median"]) for figure in figures)


def report(*figures: Figure) -> BenchReport:
    return BenchReport.of(list(figures))


def test_a_report_is_read_as_it_was_written(tmp_path: Path) -> None:
    path, written = tmp_path / "old.json", report(*LIMITS.figures)
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
