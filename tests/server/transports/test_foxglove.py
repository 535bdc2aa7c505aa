"""Foxglove: a plain client of its protocol in another process decodes by protobuf; what strangers cost."""

import contextlib
import errno
import json
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from websockets.sync.client import connect

from voltcam_client.packet import EVENT, FrameMessage, Packet
from voltcam_server.messages import events_message, frame_message, status_message
from voltcam_server.problems import UsageError
from voltcam_server.transports import FoxgloveTransport
from voltcam_server.transports.foxglove import FRAMES, PREVIEW, PREVIEW_S, RATE

from ..process import Daemon
from ..rig import PATIENCE_S, until
from .other_program import OtherProgram

WIDTH, HEIGHT = 24, 16


def packet(events: list[tuple[int, int, int, int]], start_us: int = 0) -> Packet:
    return Packet(
        events=np.array(events, EVENT),
        width=WIDTH,
        height=HEIGHT,
        seq=0,
        time_base_ns=1000 * start_us,
        stamp_ns=1,
    )


class Clock:
    """Goes on by what it is told."""

    now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def transport(clock: Clock) -> Iterator[FoxgloveTransport]:
    transport = FoxgloveTransport("127.0.0.1:0", "tiny", WIDTH, HEIGHT, clock)
    transport.start()
    yield transport
    transport.stop()


def _port(transport: FoxgloveTransport) -> int:
    return int(transport.address.rpartition(":")[2])


class Watching(OtherProgram):
    """A process that subscribes."""

    def __init__(self, transport: FoxgloveTransport, file: Path, **wanted: int) -> None:
        topics = {"frames": FRAMES, "preview": PREVIEW, "rate": RATE}
        pairs = [part for key, count in wanted.items() for part in (topics[key], str(count))]
        super().__init__("foxglove_client.py", str(_port(transport)), str(file), *pairs, file=file)
        assert self.said == "subscribed"
        channels = {"frames": transport._frames, "preview": transport._previews, "rate": transport._rates}
        until(lambda: all(channels[key].has_sinks() for key in wanted), "it is taken in")


def test_frames_arrive_as_they_were_sent(transport: FoxgloveTransport, tmp_path: Path) -> None:
    images = np.random.default_rng(1).integers(0, 256, (5, HEIGHT, WIDTH), np.uint8)
    with Watching(transport, tmp_path / "seen.npz", frames=5) as watching:
        for seq, image in enumerate(images):
            transport.publish(
                frame_message(FrameMessage(image=image, seq=seq, t_us=5_000_000 + seq, stamp_ns=1))
            )
        seen = watching.result()
    np.testing.assert_array_equal(seen["image_raw"], images)
    assert seen["image_raw_ns"].tolist() == [5_000_000_000 + 1000 * seq for seq in range(5)]


def test_a_preview_has_each_event_once(transport: FoxgloveTransport, clock: Clock, tmp_path: Path) -> None:
    """The first is due at once; the next two packets wait for each other."""
    with Watching(transport, tmp_path / "seen.npz", preview=2, rate=2) as watching:
        transport.publish(status_message({}))
        transport.publish(events_message(packet([(1000, 3, 2, 1), (2000, 3, 2, 1), (2000, 5, 6, 0)])))
        until(lambda: transport.status.packets_sent == 1, "the first is in")
        transport.publish(events_message(packet([(3000, 0, 0, 0), (4000, 23, 15, 1)])))
        until(lambda: transport.status.packets_sent == 2, "the second is in")
        clock.now_s = PREVIEW_S
        transport.publish(events_message(packet([(12_000, 0, 0, 1), (12_000, 1, 0, 1)])))
        seen = watching.result()
    expected = np.full((2, HEIGHT, WIDTH), 128, np.uint8)
    expected[0, 2, 3], expected[0, 6, 5] = 128 + 80, 128 - 40
    expected[1, 15, 23], expected[1, 0, 1] = 128 + 40, 128 + 40
    np.testing.assert_array_equal(seen["events_preview"], expected)
    assert seen["events_preview_ns"].tolist() == [2_000_000, 12_000_000]
    assert seen["events_rate"].tolist() == [3 / 0.002, 4 / 0.01]


def test_a_preview_is_cut_off_at_black_and_white(
    transport: FoxgloveTransport, clock: Clock, tmp_path: Path
) -> None:
    with Watching(transport, tmp_path / "seen.npz", preview=1) as watching:
        transport.publish(events_message(packet([(1, 0, 0, 1)] * 9 + [(2, 1, 0, 0)] * 9)))
        seen = watching.result()
    assert seen["events_preview"][0, 0, :3].tolist() == [255, 0, 128]


@contextlib.contextmanager
def _stalled(transport: FoxgloveTransport) -> Iterator[None]:
    """A client that subscribes to frames, and reads nothing more."""
    with connect(
        f"ws://127.0.0.1:{_port(transport)}", subprotocols=["foxglove.sdk.v1"], max_queue=1, proxy=None
    ) as client:
        client.send(
            json.dumps({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": transport._frames.id()}]})
        )
        until(transport._frames.has_sinks, "it is taken in")
        yield


def test_a_client_that_stalls_costs_only_itself(tmp_path: Path) -> None:
    """100 MB go by it: what waits for it is bounded, the transport goes on, and another gets what is sent."""
    transport = FoxgloveTransport("127.0.0.1:0", "tiny", 1024, 1024)
    transport.start()
    try:
        with _stalled(transport), Watching(transport, tmp_path / "seen.npz", frames=100) as watching:
            for seq in range(100):
                image = np.full((1024, 1024), seq, np.uint8)
                message = frame_message(FrameMessage(image=image, seq=seq, t_us=seq, stamp_ns=1))
                transport.publish(message)
                until(lambda: not transport._outbox, "it has left")
                if seq % 8 == 7:  # a healthy client is within its queue
                    _breathe(watching)
            seen = watching.result()
        assert transport.status.packets_dropped == 0
        assert transport.failure is None
    finally:
        transport.stop()
    assert seen["image_raw"][:, 0, 0].tolist() == list(range(100))


def _breathe(watching: Watching) -> None:
    with contextlib.suppress(subprocess.TimeoutExpired):
        watching.process.wait(0.3)


def test_random_bytes_are_refused(transport: FoxgloveTransport, tmp_path: Path) -> None:
    """As a stranger's first bytes, and as messages of one who is in; the next client is served."""
    rng = np.random.default_rng(3)
    for size in (1, 3, 100, 5000, 100_000):
        address = ("127.0.0.1", _port(transport))
        with socket.create_connection(address, PATIENCE_S) as stranger:
            try:
                stranger.sendall(rng.bytes(size))
                stranger.shutdown(socket.SHUT_WR)
                while stranger.recv(65536):
                    pass
            except (
                OSError
            ) as error:  # it is let go before it is done; one that is kept waiting is none of these
                if error.errno not in (errno.ENOTCONN, errno.ECONNRESET, errno.EPIPE):
                    raise
    for size in (0, 1, 5, 13, 5000):
        with connect(
            f"ws://127.0.0.1:{_port(transport)}", subprotocols=["foxglove.sdk.v1"], proxy=None
        ) as client:
            client.send(rng.bytes(size))
            client.send(rng.bytes(size).decode("latin-1"))
            client.send(json.dumps({"op": "subscribe", "subscriptions": [{"id": -1, "channelId": 2**40}]}))
    image = np.full((HEIGHT, WIDTH), 7, np.uint8)
    with Watching(transport, tmp_path / "seen.npz", frames=1) as watching:
        transport.publish(frame_message(FrameMessage(image=image, seq=0, t_us=1, stamp_ns=1)))
        np.testing.assert_array_equal(watching.result()["image_raw"][0], image)
    assert transport.failure is None


def test_what_nobody_watches_is_not_made(transport: FoxgloveTransport) -> None:
    transport.publish(events_message(packet([(1, 0, 0, 1)])))
    until(lambda: not transport._outbox, "it has left")
    assert transport.status.packets_sent == 0


def test_a_port_that_is_taken_is_named(transport: FoxgloveTransport) -> None:
    with pytest.raises(UsageError, match=rf":{_port(transport)}: .* with --foxglove") as error:
        FoxgloveTransport(transport.address, "tiny", WIDTH, HEIGHT)
    assert "\n" not in str(error.value)


def test_without_the_library_it_says_how_to_have_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "foxglove", None)
    with pytest.raises(UsageError, match=r"--foxglove takes foxglove-sdk: pip install 'voltcam\[foxglove\]'"):
        FoxgloveTransport("127.0.0.1:0", "tiny", WIDTH, HEIGHT)


def test_a_daemon_shows_itself_in_status() -> None:
    with Daemon("--dv", "off", "--foxglove", "127.0.0.1:0") as daemon:
        address = daemon.get("status")["transports"]["foxglove"]["address"]
        assert f"Foxglove  {address}  (in Foxglove: " in daemon.banner
        address = daemon.get("status")["transports"]["foxglove"]["address"]
        with connect(address, subprotocols=["foxglove.sdk.v1"], proxy=None) as client:
            assert json.loads(client.recv(PATIENCE_S))["name"] == "voltcam davis346"
