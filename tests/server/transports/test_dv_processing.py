"""DV, read by another's program: dv-processing's NetworkReader is the oracle."""

import contextlib
import importlib.util
import threading
from collections.abc import Iterator
from pathlib import Path

import httpx
import numpy as np
import pytest

from voltcam_client import EventCamera
from voltcam_client.packet import FrameMessage
from voltcam_client.samples import (
    IMU,
    TOPIC_IMU,
    TOPIC_TRIGGERS,
    TRIGGER,
    TRIGGER_KINDS,
    SamplesMessage,
)
from voltcam_server.messages import (
    events_message,
    frame_message,
    samples_message,
)
from voltcam_server.transports import DvTransport

from ..process import Daemon
from ..rig import PATIENCE_S, until
from .dv_rig import HEIGHT, WIDTH, packet, port_of, started
from .other_program import OtherProgram


@pytest.fixture
def transport() -> Iterator[DvTransport]:
    yield from started()


class Reading(OtherProgram):
    """A process of dv-processing's NetworkReader; connected when made. It says the camera's name."""

    def __init__(self, kind: str, port: int, count: int, file: Path) -> None:
        if importlib.util.find_spec("dv_processing") is None:
            pytest.skip("dv-processing, the oracle, is not installed")
        super().__init__("network_reader.py", kind, str(port), str(count), str(file), file=file)


def test_dv_processing_reads_every_event(transport: DvTransport, tmp_path: Path) -> None:
    packets = [packet(seq, 1 + 37 * seq % 5000) for seq in range(200)]
    expected = np.concatenate([each.events for each in packets])
    with Reading("events", port_of(transport), expected.size, tmp_path / "events.npz") as reading:
        assert reading.said == "DAVIS346_EMU00001 of 346 x 260"
        until(lambda: bool(transport.status.clients), "the reader is let in")
        for each in packets:
            transport.publish(events_message(each))
        events = reading.result()["events"]
    assert events.size == expected.size
    for own, theirs in (("t", "timestamp"), ("x", "x"), ("y", "y"), ("p", "polarity")):
        np.testing.assert_array_equal(events[theirs], expected[own])
    until(lambda: transport.status.packets_sent == 200, "all are counted")


def test_dv_processing_reads_every_frame(transport: DvTransport, tmp_path: Path) -> None:
    images = np.random.default_rng(1).integers(0, 256, (3, HEIGHT, WIDTH), np.uint8)
    with Reading("frames", port_of(transport) + 1, 3, tmp_path / "frames.npz") as reading:
        assert reading.said == "DAVIS346_EMU00001 of 346 x 260"
        until(lambda: bool(transport.status.clients), "the reader is let in")
        for seq, image in enumerate(images):
            transport.publish(frame_message(FrameMessage(image=image, seq=seq, t_us=7000 + seq, stamp_ns=1)))
        result = reading.result()
    np.testing.assert_array_equal(result["images"], images)
    assert result["t_us"].tolist() == [7000, 7001, 7002]


def test_dv_processing_reads_exposures(transport: DvTransport, tmp_path: Path) -> None:
    image = np.full((HEIGHT, WIDTH), 9, np.uint8)
    frame = FrameMessage(image=image, seq=0, t_us=7250, stamp_ns=1, exposure_us=(7000, 7500))
    with Reading("frames", port_of(transport) + 1, 1, tmp_path / "frames.npz") as reading:
        until(lambda: bool(transport.status.clients), "the reader is let in")
        transport.publish(frame_message(frame))
        result = reading.result()
    assert (result["t_us"].tolist(), result["exposure_us"].tolist()) == ([7000], [500])


def test_dv_processing_reads_triggers_and_imu(transport: DvTransport, tmp_path: Path) -> None:
    triggers = np.array([(5, 1), (6, 2), (7, 8)], TRIGGER)
    samples = np.zeros(3, IMU)
    samples["t"], samples["temperature_c"], samples["gyro_deg_s"] = (5, 6, 7), 25.5, (1, 2, 3)
    streams = ((2, "triggers", TOPIC_TRIGGERS, triggers), (3, "imu", TOPIC_IMU, samples))
    for port, kind, topic, rows in streams:
        with Reading(kind, port_of(transport) + port, 3, tmp_path / f"{kind}.npz") as reading:
            assert reading.said == "DAVIS346_EMU00001 of 0 x 0"
            until(lambda: bool(transport.status.clients), "the reader is let in")
            transport.publish(samples_message(topic, SamplesMessage(samples=rows, seq=0, stamp_ns=1)))
            (theirs,) = reading.result().values()
        assert theirs.tolist() == [np.hstack(row.tolist()).tolist() for row in rows]
        until(lambda: not transport.status.clients, "the reader is forgotten")


def test_dv_processing_gets_all_that_a_davis_gives(tmp_path: Path) -> None:
    """At their rates, on one clock, and the same over ZeroMQ."""
    arguments = ("--dv", "127.0.0.1:0", "--frames", "aps", "--imu", "500", "--triggers", "20")
    with Daemon(*arguments) as daemon, contextlib.ExitStack() as stack:
        port = int(str(daemon.get("camera")["dv"]).rpartition(":")[2])
        counts = {"frames": (1, 10), "triggers": (2, 60), "imu": (3, 300)}
        readings = [
            stack.enter_context(Reading(kind, port + offset, count, tmp_path / f"{kind}.npz"))
            for kind, (offset, count) in counts.items()
        ]
        camera = stack.enter_context(EventCamera(daemon.zmq, timeout_s=PATIENCE_S))
        sample = stack.enter_context(camera.imu()).receive(PATIENCE_S)
        trigger = stack.enter_context(camera.triggers()).receive(PATIENCE_S)
        frame = stack.enter_context(camera.frames()).receive(PATIENCE_S)
        frames, triggers, imu = (reading.result() for reading in readings)
    assert sample is not None
    assert trigger is not None
    assert frame is not None
    assert frame.exposure_us is not None
    assert set(np.diff(frames["t_us"]) % 40_000) == {0}  # what a busy machine skips has no frame
    assert set(frames["exposure_us"]) == {500}
    assert (frame.exposure_us[0] - frames["t_us"][0]) % 40_000 == 0
    times, kinds = triggers["triggers"].T
    assert set(np.diff(times[kinds == TRIGGER_KINDS["rising edge"]])) == {50_000}
    begins = times[kinds == TRIGGER_KINDS["exposure begins"]]
    assert set((begins - frames["t_us"][0]) % 40_000) == {0}
    assert set(np.diff(imu["samples"][:, 0])) == {2000}
    assert np.abs(imu["samples"][:, 1:5].mean(0) - (25, 0, -1, 0)).max() < 0.01
    assert (sample.samples["t"] % 2000 == 0).all()
    assert set(trigger.samples["kind"]) <= set(TRIGGER_KINDS.values())


def test_dv_processing_gets_the_events_that_our_own_client_gets(tmp_path: Path) -> None:
    with Daemon("--dv", "127.0.0.1:0") as daemon:
        port = int(str(daemon.get("camera")["dv"]).rpartition(":")[2])
        ours, done = [], threading.Event()

        def listen() -> None:
            with EventCamera(daemon.zmq, timeout_s=PATIENCE_S) as camera:
                for packet in camera:
                    ours.append(packet.events)
                    if done.is_set():
                        return

        listener = threading.Thread(target=listen)
        listener.start()
        until(lambda: len(ours) > 0, "our own client listens")
        with Reading("events", port, 30_000, tmp_path / "events.npz") as reading:
            theirs = reading.result()["events"]
        until(lambda: ours[-1].size > 0 and ours[-1]["t"][-1] > theirs["timestamp"][-1], "ours has all")
        done.set()
        listener.join(PATIENCE_S)
        transports = daemon.get("status")["transports"]
        metrics = httpx.get(daemon.url + "metrics", trust_env=False).text
    events = np.concatenate(ours)
    first, last = theirs["timestamp"][[0, -1]]
    events = events[(events["t"] > first) & (events["t"] < last)]
    theirs = theirs[(theirs["timestamp"] > first) & (theirs["timestamp"] < last)]
    assert events.size == theirs.size > 10_000
    for own, their_name in (("t", "timestamp"), ("x", "x"), ("y", "y"), ("p", "polarity")):
        np.testing.assert_array_equal(theirs[their_name], events[own])
    assert transports["dv"]["packets_sent"] > 0
    assert 'voltcam_packets_sent_total{camera="davis346",transport="dv"}' in metrics
