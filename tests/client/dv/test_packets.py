"""Packets against those of dv-processing, and against a flatbuffer in which a stranger has put anything."""

import contextlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_client.dv.packets import (
    events_packet,
    frame_packet,
    imu_packet,
    read_events,
    read_frame,
    read_imu,
    read_triggers,
    triggers_packet,
)
from voltcam_client.encodings import EVENT
from voltcam_client.errors import PacketError
from voltcam_client.samples import IMU, TRIGGER, TRIGGER_KINDS

EVENTS = np.array([(1_000_000, 1, 2, True), (1_000_005, 3, 4, False)], EVENT)
SAMPLES = np.array([(t, 25.5, (1, 2, 3), (4, 5, 6)) for t in (1_000_000, 1_000_001)], IMU)
TRIGGERS = np.array(
    [(1_000_000, TRIGGER_KINDS["rising edge"]), (1_000_001, TRIGGER_KINDS["exposure ends"])], TRIGGER
)
IMAGE = np.arange(12, dtype=np.uint8).reshape(3, 4)
READERS = {
    "EVTS": (read_events, bytes(events_packet(EVENTS))),
    "FRME": (read_frame, bytes(frame_packet(IMAGE, (5, 9)))),
    "IMUS": (read_imu, imu_packet(SAMPLES)),
    "TRIG": (read_triggers, triggers_packet(TRIGGERS)),
}


def test_a_packet_of_events_is_that_of_dv_processing(sent_by_dv) -> None:
    assert sent_by_dv("EVTS")[1] == events_packet(EVENTS)


def test_the_other_packets_of_dv_processing_are_read(sent_by_dv) -> None:
    np.testing.assert_array_equal(read_imu(sent_by_dv("IMUS")[1]), SAMPLES)
    np.testing.assert_array_equal(read_triggers(sent_by_dv("TRIG")[1]), TRIGGERS)
    frame = read_frame(sent_by_dv("FRME")[1])
    np.testing.assert_array_equal(frame.image, IMAGE)
    assert (frame.t_us, frame.exposure_us) == (1_000_000, (1_000_000, 1_000_000))


@pytest.mark.parametrize("count", [0, 1, 2, 3, 70_000])
def test_what_is_written_is_read_back(count: int) -> None:
    rng = np.random.default_rng(count)
    events = np.empty(count, EVENT)
    for name, limit in (("t", 2**62), ("x", 2**15), ("y", 2**15), ("p", 2)):
        events[name] = rng.integers(0, limit, count)
    np.testing.assert_array_equal(read_events(events_packet(events)), events)
    np.testing.assert_array_equal(read_events(bytes(events_packet(events, room=8)[8:])), events)
    few = rng.integers(0, 2**62, min(count, 500))
    samples = np.zeros(few.size, IMU)
    samples["t"], samples["accel_g"] = few, rng.random((few.size, 3))
    np.testing.assert_array_equal(read_imu(imu_packet(samples)), samples)
    triggers = np.zeros(few.size, TRIGGER)
    triggers["t"], triggers["kind"] = few, rng.integers(0, 10, few.size)
    np.testing.assert_array_equal(read_triggers(triggers_packet(triggers)), triggers)


def test_a_frame_comes_back_with_its_exposure() -> None:
    frame = read_frame(frame_packet(IMAGE, (2**50, 2**50 + 500), (2**50 - 9, 2**50 + 999)))
    np.testing.assert_array_equal(frame.image, IMAGE)
    assert (frame.t_us, frame.exposure_us) == (2**50, (2**50, 2**50 + 500))


def test_a_cut_packet_holds_the_events_before_the_cut() -> None:
    packet = bytes(events_packet(EVENTS))
    for kept, whole in ((32, 0), (47, 0), (48, 1), (63, 1), (64, 2)):
        np.testing.assert_array_equal(read_events(packet[:kept], cut=True), EVENTS[:whole])
    with pytest.raises(PacketError, match="longer than its packet"):
        read_events(packet[:48])


def test_pixels_that_a_record_does_not_hold_are_refused() -> None:
    with pytest.raises(PacketError, match="up to 32767"):
        events_packet(np.array([(0, 32768, 0, True)], EVENT))


def test_another_packet_is_refused() -> None:
    for name, (reader, _) in READERS.items():
        others = [packet for other, (_, packet) in READERS.items() if other != name]
        for packet in (*others, b"", b"\0" * 100):
            with pytest.raises(PacketError, match=f"no {name} packet"):
                reader(packet)


@pytest.mark.parametrize("name", READERS)
@settings(max_examples=300, deadline=None)
@given(data=st.data())
def test_damaged_packets_give_a_packet_error_or_what_they_hold(name: str, data: st.DataObject) -> None:
    reader, packet = READERS[name]
    damaged = bytearray(packet)
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(damaged) - 4))
        damaged[at : at + 4] = data.draw(st.integers(0, 2**32 - 1)).to_bytes(4, "little")
    kept = data.draw(st.integers(0, len(damaged)))
    with contextlib.suppress(PacketError):
        reader(bytes(damaged[:kept]))
