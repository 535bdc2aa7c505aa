"""What `voltcam bench` measures, on a small scene and by a clock of the test's own."""

import argparse
import json
from collections.abc import Callable
from itertools import count
from typing import Any

import numpy as np
import pytest

from voltcam_server.bench import cli
from voltcam_server.bench.cli import cost_per_event, speed, timed
from voltcam_server.bench.figure import Figure
from voltcam_server.bench.limits import MachineLimits
from voltcam_server.bench.scene import moving
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


def test_each_repeat_is_timed_and_events_are_of_one() -> None:
    frames = moving(6, 48, 36)
    seconds, events = timed(frames, 240, PAPER, clock=ticking(0.25))
    assert seconds == [0.25] * cli.REPEATS
    assert events == pytest.approx(events_of(frames, 4167), rel=0.2)  # each repeat draws numbers of its own


def test_speed_is_pixels_over_seconds_and_beside_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cli, "timed", lambda *_: ([0.5, 1.0, 2.0], 4320.0))
    (figure,) = speed(LIMITS, "small", moving(6, 48, 36), 240, PAPER)
    pixels = 5 * 48 * 36
    assert (figure.median, figure.least, figure.most) == (pixels / 1e6, pixels / 2e6, pixels / 0.5e6)
    state_bytes = Simulator(48, 36, PAPER).state_bytes
    least_s = (5 * state_bytes + pixels) / 1e9 + 4320 * 2e-9
    assert figure.remark == f"0.500 events/pixel, {1 / least_s:.1f} times the limit"


def test_an_event_costs_the_difference_of_two_thresholds(monkeypatch: pytest.MonkeyPatch) -> None:
    def by_threshold(_frames: object, _fps: float, parameters: Parameters) -> tuple[list[float], float]:
        return ([3.0], 3e8) if parameters.comparator.theta_on == 1 else ([1.0], 1e8)

    monkeypatch.setattr(cli, "timed", by_threshold)
    assert cost_per_event(moving(2, 48, 36), PAPER)[0].median == pytest.approx(10)


def test_all_of_the_plan_is_measured_and_no_two_figures_have_one_name(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Small and once; `start`, which compiles everything anew, stays with the command."""
    monkeypatch.setattr(cli, "SIZES", {"40x30": (40, 30, 3)})
    monkeypatch.setattr(cli, "REPEATS", 1)
    monkeypatch.setattr(cli, "STILL_FRAMES", 4)
    monkeypatch.setattr(cli, "moving", lambda frames, *_: moving(min(frames, 17), 40, 30))
    monkeypatch.setattr(cli, "live", lambda: [Figure.of("live", [1.0], "ms")])
    monkeypatch.setattr(cli, "start", lambda: [Figure.of("start", [1.0], "s")])
    monkeypatch.setattr(MachineLimits, "measured", lambda: LIMITS)
    arguments: Any = argparse.Namespace(what="all", json=True, compare=None)
    assert cli.run(arguments) == 0
    printed = capsys.readouterr().out
    figures = json.loads(printed)["figures"]
    names = [figure["name"] for figure in figures]
    assert len(set(names)) == len(names) == 19
    assert all(np.isfinite(figure["median"]) for figure in figures)
