"""One clock for all cameras, and where recordings lie on it."""

import threading
import time

import pytest

from voltcam_video.clock import SET_US, Clock, TimeLine


def test_it_is_the_wall_clock_advanced_by_the_monotonic_one(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = Clock()
    assert abs(clock.now_us() - time.time_ns() // 1000) < 1_000_000
    assert clock.epoch_us(2_000_000) - clock.epoch_us(1_000_000) == 1_000_000
    epoch_us, wall_ns = clock.epoch_us(0), time.time_ns

    monkeypatch.setattr(time, "time_ns", lambda: wall_ns() + 3_600_000_000_000)  # somebody sets it
    assert clock.epoch_us(0) == epoch_us
    clock.renew()
    assert clock.epoch_us(0) - epoch_us == pytest.approx(3_600_000_000, abs=1_000_000)


def test_what_two_readings_differ_by_is_not_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = Clock()
    epoch_us = clock.epoch_us(0)
    monkeypatch.setattr(Clock, "_measured_us", staticmethod(lambda: epoch_us + SET_US))
    clock.renew()
    assert clock.epoch_us(0) == epoch_us


def test_recordings_of_one_name_share_a_line_while_one_plays() -> None:
    clock = Clock()
    left, right, other = clock.line("stereo"), clock.line("stereo"), clock.line("else")
    assert left is right is not other
    assert left.shared
    assert clock.line(None) is not clock.line(None)
    left.begin(0, 100)
    del left, right
    with pytest.raises(KeyError):
        clock.line("stereo").shift_us(0)  # a new one: nobody has begun it


def test_who_comes_first_to_a_turn_says_where_it_lies() -> None:
    line = TimeLine()
    line.begin(0, 100)
    line.begin(0, 999)
    assert line.shift_us(0) == 100
    line.begin(1, 500)
    line.move(1, 7)
    assert (line.shift_us(0), line.shift_us(1)) == (100, 507)
    line.begin(2, 900)
    assert line.shift_us(0) == 900  # long past: the newest


def test_waiting_ends_at_once_where_time_is_past_or_it_is_stopped() -> None:
    clock, stop = Clock(), threading.Event()
    assert clock.wait_until(clock.now_us() - 1_000_000, stop)
    stop.set()
    assert not clock.wait_until(clock.now_us() + 3_600_000_000, stop)
