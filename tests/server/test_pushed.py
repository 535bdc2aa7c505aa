"""Frames that programs send over ZeroMQ, into a whole emulator: on the sender's clock, none lost."""

import json
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import zmq
from numpy.typing import NDArray
from tests.ports import free_port

from voltcam_client import FrameError, FrameSender
from voltcam_server.emulator import Emulator
from voltcam_simulator import Simulator
from voltcam_video import SourceError, SourceRequest

from .rig import Listener, emulating, gap_free, moving_frames, tiny, until

STAMPS_US = np.cumsum([0, 10_000, 3_000, 40_000, 5_000, 5_000, 20_000, 1_000, 9_000, 10_000]).tolist()
FRAMES = moving_frames(len(STAMPS_US), tiny())
Running = tuple[Emulator, Listener, str]


@pytest.fixture
def running() -> Iterator[Running]:
    url = f"tcp://127.0.0.1:{free_port()}"
    with emulating(SourceRequest(uri=f"zmq+{url}", levels="light")) as (emulator, listener):
        yield emulator, listener, url


def expected() -> NDArray[np.void]:
    """The simulator alone, on the same frames and stamps."""
    simulator = Simulator(24, 16, tiny().parameters)
    events = [simulator.advance(frame, t_us) for frame, t_us in zip(FRAMES, STAMPS_US, strict=True)]
    return np.concatenate(events)


@pytest.mark.parametrize(
    "pause_s", [(0.0,), (0.03,), (0.0, 0.15, 0.0, 0.01)], ids=["quick", "slow", "uneven"]
)
def test_the_sender_s_clock_alone_counts(running: Running, pause_s: tuple[float, ...]) -> None:
    _, listener, url = running
    with FrameSender(url) as sender:
        for number, (frame, t_us) in enumerate(zip(FRAMES, STAMPS_US, strict=True)):
            time.sleep(pause_s[number % len(pause_s)])
            answer = sender.send(frame, t_us)
            assert answer is not None
            assert (answer.result, answer.shift_us) == ("simulated", 0)
    listener.wait(lambda it: it.frames and it.frames[-1].t_us == STAMPS_US[-1])
    assert gap_free(listener)
    assert listener.events.tobytes() == expected().tobytes()
    assert len(expected()) > 500


def test_before_the_first_frame_it_waits_and_says_for_what(running: Running) -> None:
    emulator, listener, url = running
    assert emulator.source.state == "waiting"
    assert "waits for a program that sends frames" in emulator.source.message
    with FrameSender(url) as sender:
        sender.send(FRAMES[0], 0)
        sender.send(FRAMES[1], 10_000)
    until(lambda: emulator.source.state == "running", "it runs")
    assert emulator.source.granted is not None
    assert (emulator.source.granted["clock"], emulator.source.granted["width"]) == ("sender", 24)
    listener.wait(lambda it: it.events.size)


def test_of_frames_that_nobody_waits_for_the_newest_wins(running: Running) -> None:
    emulator, _, url = running
    follow, held = emulator.simulation.follow, []

    def slowly(arrival: Any, *rest: Any) -> Any:
        held.append(arrival.missed)
        time.sleep(0.2)
        return follow(arrival, *rest)

    emulator.simulation.follow = slowly  # type: ignore[method-assign]
    with FrameSender(url) as sender:
        for number in range(40):
            sender.send(FRAMES[number % 10], 10_000 * number, wait=False)
            time.sleep(0.01)
        sender.send(FRAMES[0], 400_000)
        assert sender.dropped > 20
        assert sender.dropped + len(held) == 41
    assert emulator.status.frames.dropped <= sender.dropped


def test_what_is_wrong_is_refused_and_changes_nothing(running: Running) -> None:
    _, listener, url = running
    with FrameSender(url) as sender:
        for number, (frame, t_us) in enumerate(zip(FRAMES, STAMPS_US, strict=True)):
            sender.send(frame, t_us)
            if number == 4:
                with pytest.raises(FrameError, match=r"not later than .* begin: true"):
                    sender.send(frame, t_us)
                with pytest.raises(FrameError, match="25 x 16 pixels after 24 x 16"):
                    sender.send(np.zeros((16, 25), np.uint8), t_us + 1)
                with pytest.raises(FrameError, match="no whole png image"):
                    sender.send(b"\x89PNG and no more", t_us + 1, encoding="png")
    listener.wait(lambda it: it.frames and it.frames[-1].t_us == STAMPS_US[-1])
    assert listener.events.tobytes() == expected().tobytes()


def test_another_run_begins_where_it_says_so(running: Running) -> None:
    """Time goes back in the sender's program, and not in the camera."""
    _, listener, url = running
    with FrameSender(url) as sender:
        for start in (0, 0):
            for number in range(3):
                answer = sender.send(FRAMES[number], start + 10_000 * number, begin=number == 0)
    assert answer is not None
    assert answer.shift_us > 20_000
    listener.wait(lambda it: len(it.frames) == 6)
    assert (np.diff([frame.t_us for frame in listener.frames]) > 0).all()


def test_ten_lines_of_any_language_will_do(running: Running) -> None:
    """ZeroMQ and JSON, none of our client; what is garbage is answered, and the sender may go on."""
    _, listener, url = running
    context = zmq.Context()
    socket = context.socket(zmq.REQ)
    socket.rcvtimeo = 20_000
    socket.connect(url)

    def ask(*parts: bytes) -> dict[str, Any]:
        socket.send_multipart(parts)
        return dict(json.loads(socket.recv()))

    try:
        for bad in (
            (b"hello",),
            (b"{}", b""),
            (b"\xff" * 5000, b""),
            (b'{"t_us": 1}', bytes(5)),
            (b"", b"", b""),
        ):
            answer = ask(*bad)
            assert answer["result"] == "refused"
            assert answer["reason"]
        for number in range(4):
            header = {"t_us": 10_000 * number, "encoding": "mono8", "width": 24, "height": 16}
            assert ask(json.dumps(header).encode(), FRAMES[number].tobytes())["result"] == "simulated"
        listener.wait(lambda it: it.events.size > 100)
    finally:
        context.destroy(0)


def test_a_sender_may_vanish_and_come_back(running: Running) -> None:
    _, listener, url = running
    for part in (slice(0, 5), slice(5, None)):
        sender = FrameSender(url)
        for frame, t_us in zip(FRAMES[part], STAMPS_US[part], strict=True):
            sender.send(frame, t_us)
        sender._socket.close(0)  # as when its process dies
    listener.wait(lambda it: it.frames and it.frames[-1].t_us == STAMPS_US[-1])
    assert listener.events.tobytes() == expected().tobytes()


@pytest.mark.parametrize(
    "uri", ["zmq+tcp://127.0.0.1", "zmq+tcp://127.0.0.1:0", "zmq+tcp://127.0.0.1:99999", "zmq+ipc://a"]
)
def test_an_endpoint_that_is_none_is_said_in_a_line(uri: str) -> None:
    with pytest.raises(SourceError, match="give zmq\\+tcp://HOST:PORT"), emulating(SourceRequest(uri=uri)):
        pass


def test_a_port_that_others_have_is_said() -> None:
    context = zmq.Context()
    other = context.socket(zmq.ROUTER)
    port = other.bind_to_random_port("tcp://127.0.0.1")
    try:
        with (
            pytest.raises(SourceError, match="Address already in use: end the program that has it"),
            emulating(SourceRequest(uri=f"zmq+tcp://127.0.0.1:{port}")),
        ):
            pass
    finally:
        context.destroy(0)


def test_the_same_inlet_can_be_asked_for_again(running: Running) -> None:
    emulator, _, url = running
    with FrameSender(url) as sender:
        sender.send(FRAMES[0], 0)
    emulator.look_at(SourceRequest(uri=f"zmq+{url}", levels="light"))
    with FrameSender(url) as sender:
        assert sender.send(FRAMES[1], 5) is not None
