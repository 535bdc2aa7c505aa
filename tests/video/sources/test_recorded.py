import threading
from collections.abc import Callable, Iterator
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np
import pytest

from voltcam_video import Clock, Frame
from voltcam_video.sources.recorded import LATE_US, play

if TYPE_CHECKING:
    from ..conftest import StillClock

START_US = 1_700_000_000_000_000


def take_of(*times_us: int) -> Callable[[], Iterator[Frame]]:
    return lambda: (Frame(np.full((1, 1), i, np.uint8), t) for i, t in enumerate(times_us))


def test_fast_keeps_the_recordings_times_and_does_not_wait(still_clock: "StillClock") -> None:
    frames = list(
        play(take_of(70, 100, 1000), loop=False, realtime=False, clock=still_clock, stop=threading.Event())
    )
    assert [frame.t_us for frame in frames] == [70, 100, 1000]
    assert still_clock.waits == []
    assert not any(frame.cut for frame in frames)


def test_realtime_gives_each_frame_at_its_due_time_on_the_wall_clock(still_clock: "StillClock") -> None:
    frames = list(
        play(take_of(70, 100, 1000), loop=False, realtime=True, clock=still_clock, stop=threading.Event())
    )
    due = [START_US, START_US + 30, START_US + 930]
    assert [frame.t_us for frame in frames] == due
    assert still_clock.waits == due


@pytest.mark.parametrize(("realtime", "start_us"), [(False, 0), (True, START_US)])
def test_a_loop_runs_on_without_a_gap(still_clock: "StillClock", realtime: bool, start_us: int) -> None:
    playing = play(
        take_of(0, 10, 30), loop=True, realtime=realtime, clock=still_clock, stop=threading.Event()
    )
    frames = list(islice(playing, 7))
    assert [frame.t_us - start_us for frame in frames] == [0, 10, 30, 50, 60, 80, 100]
    assert [int(frame.image[0, 0]) for frame in frames] == [0, 1, 2, 0, 1, 2, 0]
    assert [frame.cut for frame in frames] == [False, False, False, True, False, False, True]


def test_a_looped_single_frame_gets_a_period(still_clock: "StillClock") -> None:
    playing = play(take_of(5), loop=True, realtime=False, clock=still_clock, stop=threading.Event())
    assert [frame.t_us for frame in islice(playing, 3)] == [5, 33_338, 66_671]


def test_an_empty_take_ends_even_in_a_loop(still_clock: "StillClock") -> None:
    assert not list(play(take_of(), loop=True, realtime=False, clock=still_clock, stop=threading.Event()))


def test_a_little_late_keeps_the_time_line_and_very_late_moves_it(still_clock: "StillClock") -> None:
    times = (0, 10_000, 20_000, 30_000)
    playing = play(take_of(*times), loop=False, realtime=True, clock=still_clock, stop=threading.Event())
    assert next(playing).t_us == START_US
    still_clock.time_us = START_US + 15_000
    assert next(playing).t_us == START_US + 10_000
    still_clock.time_us = START_US + 20_000 + LATE_US + 1
    assert next(playing).t_us == START_US + 20_000 + LATE_US + 1
    assert next(playing).t_us == START_US + 30_000 + LATE_US + 1


def test_stop_ends_the_wait_and_the_recording() -> None:
    stop = threading.Event()
    playing = play(take_of(0, 3_600_000_000), loop=False, realtime=True, clock=Clock(), stop=stop)
    next(playing)
    threading.Timer(0.05, stop.set).start()
    assert next(playing, None) is None


def test_recordings_of_one_rig_show_one_moment_at_one_time_in_every_turn(still_clock: "StillClock") -> None:
    left, right = (
        play(
            take_of(0, 1000, 2000),
            loop=True,
            realtime=True,
            clock=still_clock,
            stop=threading.Event(),
            rig="head",
        )
        for _ in range(2)
    )
    first = next(left)
    still_clock.time_us += 700  # the other camera takes its time to open
    pairs = [(first, next(right)), *islice(zip(left, right, strict=True), 6)]
    assert [one.t_us for one, _ in pairs] == [START_US + t_us for t_us in range(0, 7000, 1000)]
    assert all(one.t_us == other.t_us for one, other in pairs)


def test_who_is_late_on_a_rig_leaves_frames_out_and_moves_nobody(still_clock: "StillClock") -> None:
    times_us = range(0, 3_000_000, 50_000)
    left, right = (
        play(
            take_of(*times_us),
            loop=False,
            realtime=True,
            clock=still_clock,
            stop=threading.Event(),
            rig="head",
        )
        for _ in range(2)
    )
    next(left), next(right)
    still_clock.time_us += 1_000_000  # the one on the right is held up
    assert next(right).t_us == START_US + 1_000_000 - LATE_US
    assert {frame.t_us for frame in right} < {START_US + t_us for t_us in times_us}
    assert next(left).t_us >= START_US + 1_000_000 - LATE_US


def test_a_rig_that_nobody_plays_is_forgotten(still_clock: "StillClock") -> None:
    stop = threading.Event()
    for start_us in (0, 5):
        playing = play(take_of(70), loop=False, realtime=True, clock=still_clock, stop=stop, rig="head")
        assert [frame.t_us for frame in playing] == [START_US + start_us]
        still_clock.time_us += 5
        del playing
