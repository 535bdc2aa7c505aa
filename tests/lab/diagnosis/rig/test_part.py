"""The part of a recording that is looked at."""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_lab.diagnosis.rig.part import cut, sample
from voltcam_lab.diagnosis.rig.settings import DEFAULT_RECORDING, RecordingSettings
from voltcam_lab.recordings import Footage
from voltcam_simulator import Camera

PAPER = Camera.load("paper")


def test_a_camera_that_gives_no_events_yet_is_not_silent(tiny: Footage) -> None:
    t_us = tiny.events["t"]
    for kept in (t_us > 500_000, t_us < 1_500_000):
        part = cut(replace(tiny, events=tiny.events[kept]), DEFAULT_RECORDING)
        assert part.frame_t_us is not None
        assert part.frames is not None
        assert len(part.frames) == len(part.frame_t_us)
        assert len(part.events) == kept.sum()
        begin, end = part.events["t"][0] - part.frame_t_us[0], part.frame_t_us[-1] - part.events["t"][-1]
        assert 0 <= min(begin, end) <= np.diff(part.frame_t_us).max()
        assert np.ptp(part.frame_t_us) == pytest.approx(1_500_000, abs=10_000)


@pytest.mark.parametrize(("lamp_hz", "columns"), [(100, 32), (1000, 18), (5000, 12)])
def test_of_a_camera_that_takes_many_steps_less_is_looked_at(
    tiny: Footage, lamp_hz: float, columns: int
) -> None:
    """A lamp of 1 kHz has the simulator stop every 62 us: 24 million steps of a pixel in 2 s."""
    fast = PAPER.parameters.changed({"flicker": {"frequency_hz": lamp_hz, "depth": 0.1}})
    assert len(sample(tiny, RecordingSettings(most_samples=10**9), fast.longest_step_us)) == columns


def test_strips_are_where_most_and_where_little_changes(tiny: Footage) -> None:
    frames = np.full((20, 24, 32), 100, np.uint8)
    frames[::2, :, 8:14] = 50
    columns = sample(replace(tiny, frames=frames), RecordingSettings(most_samples=20 * 24 * 12))
    assert set(range(8, 12)) < set(columns.tolist())
    assert len(set(columns.tolist()) - set(range(6, 18))) == 6


def test_cut_leaves_events_and_frames_of_the_same_time(tiny: Footage) -> None:
    part = cut(tiny, RecordingSettings(seconds=0.5))
    assert part.frame_t_us is not None
    assert part.frames is not None
    assert len(part.frames) == len(part.frame_t_us) == 101
    assert part.events["t"].max() <= part.frame_t_us[-1] == 500_000


def test_where_strips_had_many_of_the_events_the_whole_sensor_is_looked_at(tiny: Footage) -> None:
    most = len(tiny.events) // 2
    few, more = (RecordingSettings(most_events=most, whole_share=share) for share in (0.6, 0.4))
    assert len(sample(tiny, few)) == 14
    assert len(sample(tiny, more)) == 32
