"""Frames to an emulated camera: `FrameSender("tcp://127.0.0.1:5570").send(image, t_us)`."""

from typing import Any, Self

import numpy as np
import numpy.typing as npt
import zmq

from voltcam_client.errors import PacketError, VoltcamError
from voltcam_client.pushed_frame import (
    ENCODINGS,
    MOST_BYTES,
    Answer,
    FrameHeader,
    decode_answer,
    decode_header,
    encode_header,
)

UNDER_WAY = 4  # frames that nobody waits for, and that have not left this process
LINGER_MS = 1000

Pixels = npt.NDArray[np.uint8] | npt.NDArray[np.uint16]


class FrameError(VoltcamError):
    """The camera has refused a frame; nothing has changed there."""


class FrameSender:
    """Sends frames, with times of your own, to a daemon that runs with `--source zmq+tcp://HOST:PORT`.

    - `url`: `tcp://HOST:PORT`.
    - `timeout_s`: how long `send` waits for an answer.
    - `dropped`: frames that nobody waited for, and that were left out because a newer one came.

    One thread at a time. Raises VoltcamError for an address that is none.
    """

    def __init__(self, url: str, *, timeout_s: float = 30.0) -> None:
        self.url = url
        self.timeout_s = timeout_s
        self.dropped = 0
        self._refused: Answer | None = None
        self._socket = self._connected()

    def send(
        self,
        image: Pixels | bytes,
        t_us: int,
        *,
        encoding: str | None = None,
        wait: bool = True,
        begin: bool = False,
    ) -> Answer | None:
        """Send one frame; wait for its turn, and return what became of it.

        - `image`: (H, W), (H, W, 3) or (H, W, 4), uint8 or uint16, rows from the top; or the bytes of a JPEG
          or PNG file.
        - `t_us`: your clock; later than that of the frame before.
        - `encoding`: rgb, bgr, rgba or bgra, with 8 or 16, which colour needs; jpeg or png for bytes. Without
          it, grey.
        - `wait`: False returns None at once. The newest frame wins, and `dropped` counts the others.
        - `begin`: the frame does not follow from the one before; time and size may be any.

        Raises FrameError for a frame that the camera refuses, or for an earlier one that nobody waited for;
        PacketError for one that cannot be sent; TimeoutError without an answer: it may have been taken.
        """
        header, data = _message(image, t_us, encoding, wait, begin)
        while self._socket.poll(0):
            self._note(decode_answer(self._socket.recv()))
        self._raise_refused()
        try:
            # An image that nobody waits for is copied: it may change before it leaves.
            flags = 0 if wait else zmq.NOBLOCK
            self._socket.send_multipart([encode_header(header), data], flags, copy=not wait)
        except zmq.Again:
            if wait:
                raise self._no_answer() from None
            self.dropped += 1
            return None
        return self._answer_to(t_us) if wait else None

    def close(self) -> None:
        """Let the camera go; frames that nobody waited for have a second to leave."""
        self._socket.close(LINGER_MS)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc_info: object) -> None:
        self.close()

    def _answer_to(self, t_us: int) -> Answer:
        """Waits for it. Raises FrameError, TimeoutError."""
        while self._socket.poll(round(1000 * self.timeout_s)):
            answer = decode_answer(self._socket.recv())
            self._note(answer)
            if answer.t_us == t_us:
                self._raise_refused()
                return answer
        raise self._no_answer()

    def _note(self, answer: Answer) -> None:
        self.dropped += answer.result == "dropped"
        if answer.result == "refused":
            self._refused = answer

    def _raise_refused(self) -> None:
        refused, self._refused = self._refused, None
        if refused is not None:
            raise FrameError(f"{self.url} refused the frame at {refused.t_us} us: {refused.reason}")

    def _no_answer(self) -> TimeoutError:
        """What comes later is the answer to a frame that nobody waits for any more."""
        self._socket.close(0)
        self._socket = self._connected()
        return TimeoutError(
            f"no answer from {self.url} for {self.timeout_s:g} s: is `voltcam serve --source zmq+{self.url}` "
            "running there?"
        )

    def _connected(self) -> zmq.SyncSocket:
        socket: zmq.SyncSocket = zmq.Context.instance().socket(zmq.DEALER)
        socket.linger = LINGER_MS
        socket.sndhwm = UNDER_WAY
        socket.sndtimeo = round(1000 * self.timeout_s)
        socket.ipv6 = "[" in self.url
        try:
            socket.connect(self.url)
        except zmq.ZMQError as error:
            socket.close()
            raise VoltcamError(
                f"cannot send to {self.url!r} ({error.strerror}): give tcp://HOST:PORT"
            ) from error
        return socket


def _message(
    image: Pixels | bytes, t_us: int, encoding: str | None, wait: bool, begin: bool
) -> tuple[FrameHeader, Any]:
    """Header and data of a frame. PacketError for one that no camera takes."""
    width = height = None
    data: Any = image
    if not isinstance(image, bytes):
        encoding = encoding or f"mono{8 * image.itemsize}"
        height, width = _size(image, encoding)
        data = np.ascontiguousarray(image).astype(ENCODINGS[encoding].dtype, copy=False).data
    header = FrameHeader(
        t_us=int(t_us), encoding=encoding or "none", width=width, height=height, wait=wait, begin=begin
    )
    decode_header(encode_header(header))  # as the camera will, before a large image is sent
    if memoryview(data).nbytes > MOST_BYTES:
        raise PacketError(f"an image of {memoryview(data).nbytes} bytes: send at most {MOST_BYTES}")
    return header, data


def _size(image: Pixels, encoding: str) -> tuple[int, int]:
    layout = ENCODINGS.get(encoding)
    if layout is None:
        raise PacketError(f"encoding is {encoding!r}: give one of {', '.join(ENCODINGS)}, or bytes of a file")
    shape = image.shape if image.ndim == 3 else (*image.shape, 1)
    if len(shape) != 3 or shape[2] != len(layout.channels) or image.dtype != np.dtype(layout.dtype):
        raise PacketError(
            f"an image of {image.shape} {image.dtype} is no {encoding}: give (H, W), or (H, W, 3 or 4) and "
            "its encoding, uint8 or uint16"
        )
    return shape[0], shape[1]
