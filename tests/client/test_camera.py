"""EventCamera against a publisher that dies, returns, floods and talks nonsense."""

import asyncio
import gc
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from voltcam_client import EventCamera, PacketError, VoltcamError
from voltcam_client.packet import TOPIC_EVENTS, TOPIC_FRAMES

NOBODY = "tcp://127.0.0.1:1"


def test_packets_arrive_as_they_were_sent(publisher: Any, make_packet: Any) -> None:
    with EventCamera(publisher.url, timeout_s=10) as camera:
        publisher.wait_for_subscribers()
        sent = [make_packet(seq, n) for seq, n in enumerate((0, 1, 10_000))]
        publisher.send(*sent)
        for packet, received in zip(sent, camera, strict=False):
            np.testing.assert_array_equal(received.events, packet.events)
            assert (received.seq, received.width, received.dropped) == (packet.seq, packet.width, 7)
            if received.seq == 2:
                break
        assert (camera.lost_packets, camera.restarts) == (0, 0)


def test_a_daemon_may_be_at_an_ipv6_address(publish: Any, make_packet: Any) -> None:
    try:
        socket.create_server(("::1", 0), family=socket.AF_INET6).close()
    except OSError:
        pytest.skip("this machine has no IPv6")
    there = publish(host="[::1]")
    with EventCamera(there.url, timeout_s=10) as camera:
        there.wait_for_subscribers()
        there.send(make_packet(3))
        assert next(camera).seq == 3


def test_gaps_in_seq_are_lost_packets_and_a_seq_that_goes_back_is_a_restart(
    publisher: Any, make_packet: Any
) -> None:
    with EventCamera(publisher.url, timeout_s=10) as camera:
        publisher.wait_for_subscribers()
        publisher.send(*map(make_packet, (100, 101, 105, 106, 0, 2)))
        counts = []
        for _ in range(6):
            next(camera)
            counts.append((camera.lost_packets, camera.restarts))
    assert counts == [(0, 0), (0, 0), (3, 0), (3, 0), (3, 1), (4, 1)]


def test_it_reconnects_when_the_daemon_comes_back(publish: Any, make_packet: Any) -> None:
    first = publish()
    with EventCamera(first.url, timeout_s=10) as camera:
        first.wait_for_subscribers()
        first.send(make_packet(7))
        assert next(camera).seq == 7
        first.close()
        second = publish(port=first.port)
        # A ZeroMQ subscriber subscribes again from within receive(): the daemon sends until then.
        deadline = time.monotonic() + 10
        packet = None
        while packet is None and time.monotonic() < deadline:
            second.send(make_packet(0))
            packet = camera.receive(0.02)
        assert packet is not None
        assert packet.seq == 0
        assert (camera.lost_packets, camera.restarts) == (0, 1)


def test_it_may_be_there_before_the_daemon(publish: Any, make_packet: Any) -> None:
    gone = publish()
    gone.close()
    with EventCamera(gone.url, timeout_s=10) as camera:
        assert camera.receive(0) is None
        daemon = publish(port=gone.port)
        daemon.wait_for_subscribers(client=camera)
        daemon.send(make_packet(3))
        assert next(camera).seq == 3


def test_a_timeout_names_the_address_and_the_remedy(publisher: Any, make_packet: Any) -> None:
    with EventCamera(publisher.url, timeout_s=0.05) as camera:
        with pytest.raises(TimeoutError) as caught:
            next(camera)
        assert (
            str(caught.value) == f"nothing from {publisher.url} for 0.05 s: is `voltcam serve` running there?"
        )
        publisher.wait_for_subscribers()
        publisher.send(make_packet(0))
        assert camera.receive(10).seq == 0  # type: ignore[union-attr]  # iterating may go on after it


def test_a_slow_reader_loses_packets_and_not_memory(publish: Any, make_packet: Any) -> None:
    publisher = publish(queue_length=10)
    with EventCamera(publisher.url, queue_length=10) as camera:
        publisher.wait_for_subscribers()
        for seq in range(2000):
            publisher.send(make_packet(seq, 8000))  # 128 MB, while nobody reads
        received = 0
        while camera.receive(0.5) is not None:
            received += 1
        publisher.send(make_packet(2000))
        assert next(camera).seq == 2000
    assert 0 < received < 500
    assert camera.lost_packets == 2000 - received


def test_frames_come_by_a_connection_of_their_own(publisher: Any, make_packet: Any, make_frame: Any) -> None:
    with EventCamera(publisher.url, timeout_s=10) as camera, camera.frames() as frames:
        publisher.wait_for_subscribers(TOPIC_EVENTS)
        publisher.wait_for_subscribers(TOPIC_FRAMES)
        publisher.send(make_frame(0), make_packet(0), make_frame(3))
        received = [next(frames), next(frames)]
        assert next(camera).seq == 0
    assert [frame.t_us for frame in received] == [0, 3000]
    assert received[1].image.shape == (30, 40)
    assert (received[1].image == 3).all()
    assert frames.lost_packets == 2


def test_latency_is_the_age_of_the_packet(publisher: Any, make_packet: Any) -> None:
    with EventCamera(publisher.url, timeout_s=10) as camera:
        assert camera.latency_us is None
        publisher.wait_for_subscribers()
        packet = make_packet(0)
        publisher.send(packet)
        next(camera)
        upper_us = (time.time_ns() - packet.stamp_ns) // 1000
        assert camera.latency_us is not None
        assert 0 <= camera.latency_us <= upper_us


def test_async_for_lets_other_tasks_run(publisher: Any, make_packet: Any) -> None:
    async def read(seqs: list[int]) -> None:
        async with EventCamera(publisher.url, timeout_s=10) as camera:
            async for packet in camera:
                seqs.append(packet.seq)
                if packet.seq == 49:
                    return

    async def run() -> tuple[list[int], list[int]]:
        one: list[int] = []
        other: list[int] = []
        async with asyncio.timeout(20), asyncio.TaskGroup() as tasks:
            tasks.create_task(read(one))
            tasks.create_task(read(other))
            await asyncio.to_thread(publisher.wait_for_subscribers, TOPIC_EVENTS, 2)
            publisher.send(*map(make_packet, range(50)))
        return one, other

    one, other = asyncio.run(run())
    assert one == other == list(range(50))


def test_async_timeout(publisher: Any) -> None:
    async def run() -> None:
        async with EventCamera(publisher.url, timeout_s=0.05) as camera:
            await anext(camera)

    with pytest.raises(TimeoutError, match="is `voltcam serve` running there"):
        asyncio.run(run())


def test_iterating_ends_when_it_is_closed() -> None:
    camera = EventCamera(NOBODY)
    camera.close()
    camera.close()
    assert list(camera) == []


def test_a_forgotten_camera_closes_itself() -> None:
    """`for packet in EventCamera(url): ... break` leaves nothing to warn about; warnings are errors here."""
    EventCamera(NOBODY)
    gc.collect()


@pytest.mark.parametrize("url", ["", "127.0.0.1:5560", "tcp://", "tcp://127.0.0.1", "bogus://1"])
def test_an_address_that_is_none_is_refused(url: str) -> None:
    with pytest.raises(VoltcamError, match="give tcp://HOST:PORT"):
        EventCamera(url)


def test_what_is_no_voltcam_message_is_an_error_that_names_the_address(
    publisher: Any, make_packet: Any
) -> None:
    with EventCamera(publisher.url, timeout_s=10) as camera:
        publisher.wait_for_subscribers()
        publisher.send_raw(TOPIC_EVENTS, b"hello")
        publisher.send_raw(TOPIC_EVENTS, b"hello", b"world")
        publisher.send(make_packet(0))
        for _ in range(2):
            with pytest.raises(PacketError, match=publisher.url):
                next(camera)
        assert next(camera).seq == 0


def test_a_daemon_that_ends_while_the_queue_is_full_does_not_take_the_robot_with_it() -> None:
    """libzmq aborts the process there when its own heartbeats are on."""
    program = """
import time
from conftest import Publisher, make_packet
from voltcam_client import EventCamera
publisher = Publisher(queue_length=100_000)
camera = EventCamera(publisher.url, queue_length=10)
publisher.wait_for_subscribers()
publisher.send(*(make_packet(seq) for seq in range(2000)))
publisher.close()
time.sleep(2.5)  # within which it would abort
print("alive")
"""
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=Path(__file__).parent,
        capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (0, "alive\n"), done.stderr


def test_who_waits_without_a_limit_is_told_what_for(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    waits: list[float | None] = []

    def receive(timeout_s: float | None) -> object:
        waits.append(timeout_s)
        return None if len(waits) == 1 else "a packet"

    with EventCamera("tcp://127.0.0.1:9", timeout_s=None) as camera:
        monkeypatch.setattr(camera, "receive", receive)
        assert next(camera) == "a packet"
    assert waits == [2.0, None]
    assert "nothing from tcp://127.0.0.1:9" in caplog.text
    assert "voltcam serve" in caplog.text
