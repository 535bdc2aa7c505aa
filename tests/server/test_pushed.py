"""Frames that a program sends, through the whole camera: in the sender's time, each with its answer."""

import contextlib
import json
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import zmq
from numpy.typing import NDArray
from tests.ports import free_port

from voltcam_client import FrameError, FrameSender
from voltcam_server.convert import Conversion, convert
from voltcam_server.emulator import Emulator
from voltcam_simulator import Simulator
from voltcam_video import SourceRequest

from .rig import LIVELY, Listener, emulating, moving_frames, tiny

COUNT = 30
CAMERA = tiny(**LIVELY)
FRAMES = moving_frames(COUNT, CAMERA)
T_US = [10_000 * i + 1000 * (i % 3) for i in range(COUNT)]


@contextlib.contextmanager
def listening() -> Iterator[tuple[str, Emulator, Listener]]:
    address = f"tcp://127.0.0.1:{free_port()}"
    with emulating(SourceRequest(uri=f"zmq+{address}"), CAMERA) as (emulator, listener):
        yield address, emulator, listener


def pushed(gaps_s: list[float]) -> NDArray[np.void]:
    with listening() as (address, emulator, listener), FrameSender(address) as sender:
        for image, t_us, gap_s in zip(FRAMES, T_US, gaps_s, strict=True):
            time.sleep(gap_s)
            answer = sender.send(image, t_us)
            assert answer is not None
            assert (answer.t_us, answer.result, answer.shift_us) == (t_us, "simulated", 0)
        listener.wait(lambda it: len(it.frames) == COUNT)
        assert (emulator.status.frames.received, emulator.status.frames.dropped) == (COUNT, 0)
        assert [frame.t_us for frame in listener.frames] == T_US
        return listener.events


def test_events_do_not_depend_on_when_frames_come(tmp_path: Path) -> None:
    simulator = Simulator(CAMERA.width, CAMERA.height, CAMERA.parameters, "exact", 0)
    direct = np.concatenate([simulator.advance(*each) for each in zip(FRAMES, T_US, strict=True)])
    assert direct.size > 1000
    np.savez(tmp_path / "in.npz", frames=FRAMES, t_us=T_US)
    source = SourceRequest(uri=str(tmp_path / "in.npz"), pace="fast")
    convert(Conversion(source, CAMERA, tmp_path / "out.npz", upsample="linear"))
    with np.load(tmp_path / "out.npz") as converted:
        for key in "txyp":
            np.testing.assert_array_equal(converted[key], direct[key])
    for gaps_s in ([0.0] * COUNT, [0.02] * COUNT, [0.05 * (i % 4 == 0) for i in range(COUNT)]):
        np.testing.assert_array_equal(pushed(gaps_s), direct)


def test_what_cannot_follow_is_refused_and_changes_nothing() -> None:
    with listening() as (address, _, listener), FrameSender(address) as sender:
        sender.send(FRAMES[0], T_US[0])
        sender.send(FRAMES[1], T_US[1])
        for bad, t_us, words in (
            (FRAMES[2], T_US[1], "not later than"),
            (FRAMES[2][:5], T_US[2], "24 x 5 pixels after 24 x 16"),
        ):
            with pytest.raises(FrameError, match=words):
                sender.send(bad, t_us)
        with pytest.raises(FrameError, match="no whole png"):
            sender.send(b"garbage", T_US[2], encoding="png")
        answer = sender.send(FRAMES[2], T_US[2])
        assert answer is not None
        assert answer.result == "simulated"
        listener.wait(lambda it: len(it.frames) == 3)
        assert sender.send(FRAMES[0], 0, begin=True) is not None


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ([b"{}", b""], "no t_us"),
        ([b"[" * 4000, b""], "is not JSON"),
        ([b"x" * 5000, b""], "at most 4096"),
        ([b"only one"], "1 parts"),
        ([b'{"t_us":0,"encoding":"mono8","width":2,"height":2}', b"abc"], "3 bytes are no 2 rows"),
        ([b'{"t_us":0,"encoding":"mono8","width":9999,"height":9999}', b""], "too many"),
        ([b'{"t_us":true,"encoding":"mono8","width":2,"height":2}', b"abcd"], "t_us is True"),
        ([b'{"t_us":0,"encoding":"jpeg"}', b"\xff\xd8\xff\xd9"], "no whole jpeg"),
    ],
)
def test_a_plain_socket_is_told_in_one_line(parts: list[bytes], words: str) -> None:
    with listening() as (address, emulator, _), zmq.Context() as context:
        socket = context.socket(zmq.REQ)
        socket.linger, socket.rcvtimeo = 0, 30_000
        socket.connect(address)
        socket.send_multipart(parts)
        answer = json.loads(socket.recv())
        assert answer["result"] == "refused"
        assert words in answer["reason"]
        assert "\n" not in answer["reason"]
        socket.send_multipart([b'{"t_us":0,"encoding":"mono8","width":2,"height":2}', b"abcd"])
        assert json.loads(socket.recv())["result"] == "simulated"
        assert emulator.status.frames.received == 1
        socket.close()


def test_who_does_not_wait_has_its_drops_counted() -> None:
    with listening() as (address, emulator, listener), FrameSender(address) as sender:
        for image, t_us in zip(FRAMES, T_US, strict=True):
            sender.send(image, t_us, wait=False)
        answer = sender.send(FRAMES[0], T_US[-1] + 10_000)
        assert answer is not None
        listener.wait(lambda it: it.frames and it.frames[-1].t_us == T_US[-1] + 10_000)
        counts = emulator.status.frames
        assert counts.simulated + counts.dropped + counts.skipped == counts.received
        assert counts.simulated == len(listener.frames) - counts.skipped


def test_a_sender_leaves_and_another_goes_on() -> None:
    with listening() as (address, _, listener):
        for image, t_us in zip(FRAMES[:3], T_US, strict=False):
            with FrameSender(address) as sender:
                assert sender.send(image, t_us) is not None
        listener.wait(lambda it: len(it.frames) == 3)
