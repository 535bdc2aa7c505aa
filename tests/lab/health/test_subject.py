"""A recording under examination, event by event."""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_client.encodings import EVENT
from voltcam_lab.health.subject import Subject, subject_of
from voltcam_lab.recordings import Footage

T_US = np.array([1000, 11_000, 21_000, 41_000, 51_000])


def footage(*rows: tuple[int, int, int, bool]) -> Footage:
    """5 frames of 8 x 6 pixels; the right half changes at each frame."""
    frames = np.full((5, 6, 8), 80, np.uint8)
    frames[::2, :, 4:] = 200
    return Footage(np.array(list(rows), EVENT), 8, 6, frames, T_US)


def times(*t_us: int) -> Subject:
    return subject_of(footage(*((t, 1, 2, True) for t in t_us)))


def test_each_event_has_its_interval_and_none_outside_the_frames() -> None:
    found = times(0, 999, 1000, 10_999, 11_000, 40_000, 50_999, 51_000, 60_000)
    assert found.interval.tolist() == [-1, -1, 0, 0, 1, 2, 3, -1, -1]
    assert found.at_rest.tolist() == [False, False, True, True, True, True, True, False, False]


def test_the_nearest_frame_is_the_nearest_and_none_half_a_period_away() -> None:
    t_us = np.arange(0, 62_000, 500)
    found = times(*t_us.tolist())
    assert found.period_us == 10_000
    distance = t_us[:, None] - T_US
    nearest = np.abs(distance).argmin(axis=1)
    assert np.abs(found.since_frame_us).tolist() == np.abs(distance).min(axis=1).tolist()
    known = np.abs(distance).min(axis=1) < 5000
    assert (found.nearest_frame[known] == nearest[known]).all()
    assert (found.nearest_frame[~known] == -1).all()


def test_what_moves_is_not_at_rest_nor_what_is_next_to_it() -> None:
    found = subject_of(footage(*((15_000, x, 3, True) for x in range(8))))
    assert found.at_rest.tolist() == [True] * 3 + [False] * 5


def test_events_are_counted_at_their_pixels() -> None:
    found = subject_of(footage((2000, 7, 0, True), (2000, 0, 5, False), (3000, 7, 0, False)))
    assert found.pixel.tolist() == [7, 40, 7]
    assert found.y.tolist() == [0, 5, 0]
    counts = found.all_counts
    assert counts.shape == (6, 8)
    assert (counts[0, 7], counts[5, 0], counts.sum()) == (2, 1, 3)
    assert found.counts(found.on)[0, 7] == found.counts(found.on).sum() == 1


def test_what_cannot_be_compared_is_refused() -> None:
    whole = footage((2000, 1, 1, True))
    with pytest.raises(ValueError, match="one frame"):
        subject_of(replace(whole, frames=whole.frames[:1], frame_t_us=T_US[:1]))
    with pytest.raises(ValueError, match="different sizes"):
        subject_of(replace(whole, frames=whole.frames[:, :5]))
