"""Packets: what is in them, and when they leave."""

import threading
import time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from voltcam_client.packet import EVENT
from voltcam_server.camera_settings import PacketSettings
from voltcam_server.interval import Interval
from voltcam_server.pacer import BURST_PACKET_US, Pacer, PlayOut, Slice, slices
from voltcam_simulator import Parameters

from .rig import PATIENCE_S

EPOCH_US = 1_700_000_000_000_000
IMAGE = np.zeros((2, 2), np.uint8)
HOUR_US = 3_600_000_000


def interval_of(t: NDArray[np.int64], start_us: int, end_us: int, paced: bool = True) -> Interval:
    events = np.zeros(t.size, EVENT)
    events["t"] = t
    events["x"] = np.arange(t.size)  # to tell them apart
    return Interval(
        events,
        start_us,
        end_us,
        end_us,
        IMAGE,
        Parameters(),
        0,
        "advanced",
        1.0,
        0.0,
        time.monotonic(),
        paced,
    )


@st.composite
def intervals(draw: st.DrawFn) -> Interval:
    start_us = draw(st.sampled_from([0, 7, EPOCH_US]))
    span_us = draw(st.integers(1, 60_000) | st.just(3_600_000_000))
    after = draw(st.lists(st.integers(0, span_us), max_size=60))
    bunch = draw(st.integers(0, 20))  # at one and the same time
    t = start_us + np.sort(np.array(after + after[:1] * bunch, np.int64))
    return interval_of(t, start_us, start_us + span_us, draw(st.booleans()))


settings = st.builds(
    PacketSettings,
    smooth=st.booleans(),
    packet_us=st.integers(100, 1000),
    packet_bytes=st.integers(8, 200),
)


@given(intervals(), settings)
def test_slices_are_the_interval_in_order_and_within_limits(
    interval: Interval, packets: PacketSettings
) -> None:
    pieces = list(slices(interval, packets))
    np.testing.assert_array_equal(np.concatenate([piece.events for piece in pieces]), interval.events)
    longest_us = packets.packet_us if packets.smooth and interval.paced else BURST_PACKET_US
    end_us = interval.start_us
    for piece in pieces:
        assert interval.start_us <= piece.start_us <= piece.end_us <= interval.end_us
        assert end_us <= piece.start_us  # one after the other
        end_us = piece.end_us
        assert 8 * piece.events.size <= packets.packet_bytes
        if piece.events.size:
            assert piece.start_us <= piece.events["t"][0]
            assert piece.events["t"][-1] <= piece.end_us
            assert piece.end_us - piece.start_us <= longest_us
    assert all(piece.events.size for piece in pieces) or len(pieces) == 1


def test_an_hour_without_but_one_event_makes_one_packet() -> None:
    interval = interval_of(np.array([HOUR_US // 2]), 0, HOUR_US)
    (piece,) = slices(interval, PacketSettings(packet_us=1000))
    assert piece.end_us - piece.start_us == 1000


@given(
    st.lists(
        st.tuples(st.floats(0.001, 0.1), st.floats(0, 0.2)),  # span, how late it is known, s
        min_size=1,
        max_size=200,
    )
)
def test_nothing_is_due_a_span_or_more_from_when_it_is_known(timing: list[tuple[float, float]]) -> None:
    play_out, start_us, ready_s = PlayOut(), EPOCH_US, 0.0
    for span_s, late_s in timing:
        end_us = start_us + round(span_s * 1e6)
        ready_s = max(ready_s, (end_us - EPOCH_US) / 1e6 + late_s)
        play_out.begin(start_us, end_us, ready_s)
        assert abs(play_out.due_s(start_us) - ready_s) <= span_s + 1e-5
        start_us = end_us


def played(late_s: NDArray[np.float64]) -> NDArray[np.float64]:
    """33 ms intervals that are known so late after their end: how long after it each begins to leave, s."""
    play_out, begins = PlayOut(), []
    for i, late in enumerate(late_s):
        start_us, end_us = i * 33_333, (i + 1) * 33_333
        ready_s = end_us / 1e6 + late
        play_out.begin(start_us, end_us, ready_s)
        begins.append(max(ready_s, play_out.due_s(start_us)) - end_us / 1e6)
    return np.array(begins)


def test_a_jittering_source_is_played_evenly() -> None:
    """30 frames per second that come up to 8 ms late: gaps are a few % of an interval, not 8 ms."""
    begins = played(np.random.default_rng(1).uniform(0, 0.008, 200))
    assert np.mean(np.abs(np.diff(begins[30:]))) < 0.001


def test_one_late_frame_does_not_hold_up_those_behind_it() -> None:
    late_s = np.full(200, 0.003)
    late_s[100] = 0.020
    np.testing.assert_allclose(played(late_s), late_s, atol=1e-5)


def test_a_source_that_has_become_slower_is_followed() -> None:
    begins = played(np.repeat([0.003, 0.010, 0.003], 100))
    assert begins[70:130] == pytest.approx(np.repeat([0.003, 0.010], 30), abs=1e-5)
    assert begins[-20:] == pytest.approx(0.003, abs=1e-5)


class Given:
    """What a pacer gave out, and when."""

    def __init__(self, packets: PacketSettings) -> None:
        self.slices: list[tuple[float, Slice]] = []
        self.ended: list[Interval] = []
        self.changed = threading.Condition()
        self.pacer = Pacer(packets, self._slice, self._end)
        self.thread = threading.Thread(target=self.pacer.run)

    def _slice(self, _: Interval, piece: Slice) -> None:
        self.slices.append((time.monotonic(), piece))

    def _end(self, interval: Interval) -> None:
        with self.changed:
            self.ended.append(interval)
            self.changed.notify_all()

    def run(self, given: list[Interval], ends: int) -> None:
        """Until so many intervals have left."""
        self.thread.start()
        for interval in given:
            self.pacer.put(interval)
        with self.changed:
            assert self.changed.wait_for(lambda: len(self.ended) >= ends, PATIENCE_S)
        self.pacer.stop()
        self.thread.join(PATIENCE_S)
        assert not self.thread.is_alive()


def test_smooth_events_leave_at_their_own_pace() -> None:
    span_us = 200_000
    interval = interval_of(EPOCH_US + np.arange(0, span_us, 500), EPOCH_US, EPOCH_US + span_us)
    given = Given(PacketSettings(packet_us=1000))
    given.run([interval], ends=1)
    assert len(given.slices) == 200
    for at_s, piece in given.slices:  # a busy machine may be late, never early
        assert at_s >= interval.ready_s + (piece.end_us - EPOCH_US) / 1e6 - 1e-4


@pytest.mark.parametrize(("smooth", "paced"), [(False, True), (True, False)])
def test_a_burst_does_not_wait(smooth: bool, paced: bool) -> None:
    interval = interval_of(np.arange(0, HOUR_US, HOUR_US // 10), 0, HOUR_US, paced)
    given = Given(PacketSettings(smooth=smooth))
    given.run([interval], ends=1)
    assert len(given.slices) == 10


def test_who_is_behind_catches_up_and_drops_nothing() -> None:
    """Three intervals of an hour each: the first goes at once, since two more are there."""
    given = Given(PacketSettings())
    hours = [
        interval_of(np.array([start + 1, start + HOUR_US - 1]), start, start + HOUR_US)
        for start in (0, HOUR_US, 2 * HOUR_US)
    ]
    given.run(hours, ends=1)
    assert [piece.events["t"][0] for _, piece in given.slices] == [1, HOUR_US - 1]
