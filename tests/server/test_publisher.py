"""What leaves a camera: packets and frames, numbered, counted and as they were made."""

import time
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from voltcam_client.packet import TOPIC_STATUS
from voltcam_client.samples import IMU, TRIGGER
from voltcam_server.beside import Beside
from voltcam_server.interval import Interval
from voltcam_server.messages import Message, status_message
from voltcam_server.pacer import Slice
from voltcam_server.publisher import Publisher
from voltcam_server.stages import stage_histogram
from voltcam_simulator import EVENT, ApsFrame, Parameters

from .rig import Listener, tiny

START_US = 1_700_000_000_000_000


def interval(image: np.ndarray[Any, Any], version: int = 3, age_s: float = 0.0) -> Interval:
    """Of 10 ms, its frame come so long ago."""
    now_s, end_us = time.monotonic(), START_US + 10_000
    return Interval(
        np.empty(0, EVENT), START_US, end_us, end_us, image, Parameters(), version, "advanced", 1.0,
        now_s - age_s, now_s, True,
    )  # fmt: skip


def piece(count: int, start_us: int = START_US, end_us: int = START_US + 10_000) -> Slice:
    events = np.zeros(count, EVENT)
    events["t"], events["x"] = start_us, np.arange(count)
    return Slice(events, start_us, end_us)


class Kept(Listener):
    """A transport that takes what is published at once."""

    def publish(self, message: Message) -> None:
        self._send(message)


@pytest.fixture
def transports() -> list[Kept]:
    return [Kept(), Kept()]


def publisher(transports: list[Kept], dropped: list[int] | None = None) -> Publisher:
    counts = dropped or [0]
    return Publisher(tiny(), transports, lambda: counts[0], stage_histogram())


GREY = np.full((16, 24), 90, np.uint8)


def test_packets_are_numbered_and_say_what_they_are(transports: list[Kept]) -> None:
    dropped = [4]
    publish = publisher(transports, dropped)
    publish.send_events(interval(GREY), piece(5))
    dropped[0] = 6
    publish.send_events(interval(GREY, version=8), piece(2, START_US + 5000))
    for transport in transports:
        first, second = transport.packets
        assert (first.seq, second.seq) == (0, 1)
        assert (first.dropped, second.dropped) == (4, 6)
        assert (first.parameters_version, second.parameters_version) == (3, 8)
        assert (first.width, first.height, first.frame_id) == (24, 16, "tiny")
        assert second.time_base_ns == 1000 * (START_US + 5000)
        np.testing.assert_array_equal(first.events, piece(5).events)
    assert (publish.packets.total, publish.events.total) == (2, 7)


def test_a_frame_of_floats_leaves_as_grey_levels(transports: list[Kept]) -> None:
    publish = publisher(transports)
    fine = np.full((16, 24), 90.6, np.float32)
    fine[0, :2] = (-3, 300)
    publish.end_interval(interval(fine))
    publish.end_interval(interval(GREY))
    first, second = transports[0].frames
    assert (first.seq, second.seq, first.t_us) == (0, 1, START_US + 10_000)
    assert first.image.dtype == np.uint8
    assert first.image[0, :3].tolist() == [0, 255, 91]
    np.testing.assert_array_equal(second.image, GREY)


def test_the_age_is_of_the_oldest_event_that_is_on_its_way(transports: list[Kept]) -> None:
    """Of a frame that came 2 s ago, and a slice that ended 6 ms before it; or what is waited for."""
    publish = publisher(transports)
    assert publish.latency(0.0).age_ms == 0
    publish.send_events(interval(GREY, age_s=2.0), piece(1, end_us=START_US + 4000))
    assert publish.latency(0.0).age_ms >= 2006
    assert publish.latency(100.0).age_ms == 100_000


def test_latency_is_of_the_newest_interval(transports: list[Kept]) -> None:
    publish = publisher(transports)
    publish.end_interval(interval(GREY, age_s=5.0))
    publish.end_interval(interval(GREY, age_s=3.0))
    latency = publish.latency(0.0)
    assert latency.simulated_ms == pytest.approx(3000, abs=0.01)
    assert latency.sent_ms >= latency.simulated_ms


def test_leaving_is_a_stage(transports: list[Kept]) -> None:
    stages = stage_histogram()
    publish = Publisher(tiny(), transports, lambda: 0, stages)
    publish.end_interval(interval(GREY))
    (count,) = [
        s for metric in stages.collect() for s in metric.samples if s.name == "voltcam_stage_seconds_count"
    ]
    assert (count.labels, count.value) == ({"stage": "leaving"}, 1)


def test_ages_are_counted_as_packets_leave(transports: list[Kept]) -> None:
    publish = publisher(transports)
    for age_s in (0.0045, 3.0):
        now = interval(GREY, age_s=age_s)
        publish.send_events(now, Slice(now.events, now.start_us, now.frame_us))
    samples = [sample for metric in publish.ages.collect() for sample in metric.samples]
    below = {float(s.labels["le"]): s.value for s in samples if s.name.endswith("bucket")}
    assert (below[0.004], below[1.0], below[5.0], below[float("inf")]) == (0, 1, 2, 2)


def test_any_message_goes_to_all_transports(transports: list[Kept]) -> None:
    publisher(transports).publish(status_message({"load": 1}))
    assert [transport.statuses for transport in transports] == [[{"load": 1}]] * 2
    assert status_message({}).topic == TOPIC_STATUS


def test_what_is_beside_events_leaves_with_them_in_order_of_time(transports: list[Kept]) -> None:
    exposures = [(START_US + t, START_US + t + 50) for t in (1000, 6000)]
    frames = tuple(ApsFrame(GREY, exposure_us, exposure_us) for exposure_us in exposures)
    imu = np.zeros(3, IMU)
    imu["t"] = START_US + np.array([500, 2500, 9500])
    triggers = np.array([(START_US + 10_000, 1)], TRIGGER)
    asked = replace(interval(GREY), beside=Beside(frames, imu, triggers))
    publish = Publisher(tiny(), transports, lambda: 0, stage_histogram(), "aps")
    kept = transports[0]
    publish.send_events(asked, piece(1, START_US, START_US + 2000))
    assert ([frame.seq for frame in kept.frames], [len(each.samples) for each in kept.imu]) == ([0], [1])
    publish.send_events(asked, piece(1, START_US + 2000, START_US + 10_000))
    assert [frame.exposure_us for frame in kept.frames] == exposures
    assert [frame.t_us for frame in kept.frames] == [START_US + 1025, START_US + 6025]
    assert kept.triggers == []
    publish.end_interval(asked)
    np.testing.assert_array_equal(np.concatenate([each.samples for each in kept.imu]), imu)
    assert [each.seq for each in kept.imu] == [0, 1]
    np.testing.assert_array_equal(kept.triggers[0].samples, triggers)
    publish.end_interval(replace(interval(GREY), beside=Beside((), imu, triggers)))
    assert [each.seq for each in kept.imu] == [0, 1, 2]
    assert len(kept.frames) == 2  # none of the source
