"""FrameSender: images of all kinds to a socket that answers as a camera does."""

import json
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import zmq

from voltcam_client import FrameError, FrameSender, PacketError, VoltcamError

Reply = dict[str, Any]


class Inlet:
    """Keeps what comes, and answers each frame as `replies` says, or that it was simulated."""

    def __init__(self) -> None:
        self.messages: list[tuple[dict[str, Any], bytes]] = []
        self.replies: dict[int, Reply | None] = {}
        self._context, self._stop = zmq.Context(), threading.Event()
        self._socket = self._context.socket(zmq.ROUTER)
        self.url = f"tcp://127.0.0.1:{self._socket.bind_to_random_port('tcp://127.0.0.1')}"
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _run(self) -> None:
        while not self._stop.is_set():
            if self._socket.poll(10):
                sender, header, data = self._socket.recv_multipart()
                content = json.loads(header)
                self.messages.append((content, data))
                usual = {"t_us": content["t_us"], "result": "simulated", "reason": "", "shift_us": 0}
                reply = self.replies.get(content["t_us"], {})
                if reply is not None:
                    self._socket.send_multipart([sender, json.dumps(usual | reply).encode()])

    def close(self) -> None:
        self._stop.set()
        self._thread.join(10)
        self._context.destroy(0)


@pytest.fixture
def inlet() -> Iterator[Inlet]:
    inlet = Inlet()
    yield inlet
    inlet.close()


def test_an_image_is_sent_as_its_bytes_and_answered(inlet: Inlet) -> None:
    image = np.arange(12, dtype=np.uint8).reshape(3, 4)
    with FrameSender(inlet.url) as sender:
        answer = sender.send(image, 7)
        assert answer is not None
        assert (answer.t_us, answer.result) == (7, "simulated")
        sender.send(np.ones((3, 4, 3), np.uint16)[:, ::-1], 8, encoding="rgb16", begin=True)
        sender.send(b"\x89PNG", 9, encoding="png")
    (grey, data), (colour, wide), (png, file) = inlet.messages
    assert grey == {"t_us": 7, "encoding": "mono8", "width": 4, "height": 3, "wait": True, "begin": False}
    assert data == bytes(range(12))
    assert (colour["encoding"], colour["begin"], wide) == ("rgb16", True, b"\1\0" * 36)
    assert ("width" in png, file) == (False, b"\x89PNG")


def test_a_refusal_is_raised_and_the_sender_goes_on(inlet: Inlet) -> None:
    inlet.replies[3] = {"result": "refused", "reason": "t_us is 3, not later than 5"}
    image = np.zeros((2, 2), np.uint8)
    with FrameSender(inlet.url) as sender:
        with pytest.raises(FrameError, match=f"{inlet.url} refused the frame at 3 us: t_us is 3"):
            sender.send(image, 3)
        assert sender.send(image, 6) is not None


def test_frames_that_nobody_waits_for_are_counted_when_dropped(inlet: Inlet) -> None:
    inlet.replies[1] = inlet.replies[2] = {"result": "dropped", "reason": "a newer one came"}
    image = np.zeros((2, 2), np.uint8)
    with FrameSender(inlet.url) as sender:
        assert [sender.send(image, t_us, wait=False) for t_us in (1, 2)] == [None, None]
        sender.send(image, 3)
        assert sender.dropped == 2


def test_without_an_answer_it_says_what_to_do(inlet: Inlet) -> None:
    inlet.replies[1] = None
    image = np.zeros((2, 2), np.uint8)
    with FrameSender(inlet.url, timeout_s=0.2) as sender:
        with pytest.raises(
            TimeoutError, match=r"no answer .* for 0\.2 s: is `voltcam serve --source zmq\+tcp"
        ):
            sender.send(image, 1)
        assert sender.send(image, 2) is not None  # the answer to the first is not taken for this one's


@pytest.mark.parametrize(
    ("image", "encoding", "words"),
    [
        (np.zeros((2, 2, 3), np.uint8), None, "is no mono8"),
        (np.zeros((2, 2), np.float32), None, "encoding is 'mono32'"),
        (np.zeros((2, 2), np.uint8), "rgb8", "is no rgb8"),
        (b"abc", None, "encoding is 'none'"),
        (np.zeros((2, 0), np.uint8), None, "width is 0"),
    ],
)
def test_what_is_no_image_is_not_sent(inlet: Inlet, image: Any, encoding: str | None, words: str) -> None:
    with FrameSender(inlet.url) as sender, pytest.raises(PacketError, match=words):
        sender.send(image, 1, encoding=encoding)
    assert inlet.messages == []


def test_an_address_that_is_none() -> None:
    with pytest.raises(VoltcamError, match="give tcp://HOST:PORT"):
        FrameSender("nowhere")
