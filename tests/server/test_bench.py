"""What speed is measured on; the measuring itself is `voltcam bench`, not a test."""

from functools import partial

from voltcam_server.bench import plan
from voltcam_server.bench_figure import Figure
from voltcam_server.bench_scene import moving, noisy
from voltcam_simulator import Parameters, Simulator


def test_the_scene_is_the_one_that_others_were_measured_on() -> None:
    frames = moving(20, 346, 260)
    assert frames.shape == (20, 260, 346)
    assert 0.84 < (frames[1:] != frames[:-1]).mean() < 0.89
    simulator = Simulator(346, 260, Parameters.of("paper"), seed=1)
    events = sum(simulator.advance(frame, 4167 * i).size for i, frame in enumerate(frames))
    assert 0.17 < events / frames[1:].size < 0.22


def test_the_webcam_has_noise_of_two_grey_levels() -> None:
    frames = noisy(50, 64, 48).astype(float)
    inside = (frames.mean(axis=0) > 20) & (frames.mean(axis=0) < 235)
    assert abs(frames.std(axis=0)[inside].mean() - 2) < 0.1


def test_a_figure_is_its_median_and_spread() -> None:
    assert str(Figure.of("sort", [3.0, 1.0, 2.0], "ns", "quiet")).split() == [
        "sort", "2", "1", "to", "3", "ns", "quiet",
    ]  # fmt: skip


def test_every_figure_of_the_plan_is_another() -> None:
    """Planned, not measured: measuring takes a minute and belongs to the command."""
    names = [step.args[0] for step in plan() if isinstance(step, partial) and isinstance(step.args[0], str)]
    assert len(names) == len(set(names)) == 12
