"""When events come, and for how long pixels are held, of a camera of which both are known."""

from dataclasses import replace

import numpy as np
import pytest
from tests.generator import Effect, draw_base, draw_scene, record

from voltcam_lab.calibration.fit import maximise
from voltcam_lab.calibration.reading import Reading
from voltcam_lab.calibration.timing import find_times
from voltcam_lab.light.between_frames import scene_between

HELD_US = 2000.0


def sample(fps: float, effects: list[Effect]) -> Reading:
    rng = np.random.default_rng(0)
    made = record(draw_scene(rng), draw_base(rng), effects, seed=0, fps=fps, seconds=3.0)
    keep = np.ones((made.height, made.width), np.bool_)
    light = scene_between(made.frames, made.frame_t_us)
    return Reading(made.events, light, keep, np.zeros((0, 2), np.int64)).prepared().sampled(rng, 6000)


def times(reading: Reading) -> tuple[float, float]:
    """(delay, dead time) in microseconds."""
    start, _ = maximise(reading.intervals(0.0, 0.0), 0.0)
    return find_times(reading, start)


@pytest.fixture(scope="module")
def plain() -> Reading:
    return sample(240, [])


def test_neither_is_found_where_none_is(plain: Reading) -> None:
    assert times(plain) == (0.0, 0.0)
    assert times(sample(25, [])) == (0.0, 0.0)


def test_late_events_are_late(plain: Reading) -> None:
    events = plain.events.copy()
    events["t"] += 5000
    late_us, held_us = times(replace(plain, events=events))
    assert late_us == pytest.approx(5000, abs=800)  # a fifth of the time between two frames
    assert held_us == 0


def test_a_held_pixel_is_found() -> None:
    late_us, held_us = times(sample(240, [Effect("refractory_period", "", {"period_us": HELD_US})]))
    assert abs(late_us) < 500
    assert held_us == pytest.approx(HELD_US, rel=0.3)
