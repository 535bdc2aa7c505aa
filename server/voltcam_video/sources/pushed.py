"""Frames that programs send over ZeroMQ, on a clock of their own: see `voltcam_client.pushed_frame`."""

import contextlib
import os
import queue
import re
import threading
import time
from dataclasses import dataclass, replace

import zmq

from voltcam_client.errors import PacketError
from voltcam_client.pushed_frame import (
    HEADER_BYTES,
    MOST_BYTES,
    Answer,
    FrameHeader,
    Result,
    decode_header,
    encode_answer,
)
from voltcam_video.clock import Clock
from voltcam_video.frame import Frame, Outcome, Sent
from voltcam_video.request import SourceRequest
from voltcam_video.sources.pushed_image import image_of, size_of
from voltcam_video.sources.source import Source, SourceError

ENDPOINT = re.compile(r"tcp://(\[[0-9A-Fa-f:.]+\]|[^:/\s\[\]]+):([1-9]\d{0,4})")
QUEUE_MESSAGES = 2  # of each sender, so that what waits is bounded
POLL_S, POLL_MS = 0.05, 50
MOST_IN_A_ROW = 100  # messages that are looked at before the newest of them goes on
LET_GO_S, RETRY_S = 1.0, 0.02  # a port that a former source of ours had
LINGER_MS = 100  # for the last answers
NEWER = "a newer one came"
ENDS = "this camera ends, or looks at something else"


@dataclass(frozen=True, slots=True, eq=False)
class _UnderWay:
    """A frame that is to be answered. envelope: the parts that go before the answer."""

    envelope: list[bytes]
    t_us: int | None
    wait: bool


@dataclass(frozen=True, slots=True, eq=False)
class _Message:
    """A frame as it came, in order, its header checked."""

    answer_to: _UnderWay
    header: FrameHeader
    data: memoryview
    size: tuple[int, int]


class PushedSource(Source):
    """It listens. Each frame that comes is answered once, when its outcome is known.

    After one whose sender waits, none is taken before that. Of those whose senders do not wait, the newest
    goes on. Grey levels of 8 bit are taken as coded, finer ones as light.
    """

    live = True
    endless = True
    expects = True

    def __init__(self, request: SourceRequest, clock: Clock, stop: threading.Event) -> None:
        super().__init__(request, clock, stop)
        self._outcomes: queue.SimpleQueue[tuple[_UnderWay, Outcome]] = queue.SimpleQueue()
        self._under_way: list[_UnderWay] = []
        self._last: tuple[int, tuple[int, int]] | None = None  # time and size of the last frame in order
        self.granted = self._awaiting("pushed", "ZeroMQ")
        endpoint = self._endpoint()
        self._context = zmq.Context()
        self._socket = self._bound(endpoint)

    @classmethod
    def reads(cls, request: SourceRequest) -> bool:
        return request.inlet is not None

    def read(self) -> Frame | None:
        """The next frame; None where `stop` is set first."""
        while not self.stop.is_set():
            waits = any(each.wait for each in self._under_way)
            self._tell(POLL_S if waits else 0)
            if not waits and self._socket.poll(POLL_MS):
                frame = self._newest()
                if frame is not None:
                    return frame
        return None

    def close(self) -> None:
        """Frames under way, and those that wait in the socket, are answered as dropped."""
        if self._socket.closed:
            return
        self._tell(0)
        for each in self._under_way:
            self._answer(each, "dropped", ENDS)
        for _ in range(MOST_IN_A_ROW):
            if self._socket.poll(0) and (message := self._receive()) is not None:
                self._answer(message.answer_to, "dropped", ENDS)
        self._context.destroy(LINGER_MS)

    def _endpoint(self) -> str:
        """Where it is to listen. Raises SourceError."""
        parts = ENDPOINT.fullmatch(self.request.inlet or "")
        if parts is None or int(parts[2]) > 65535:
            raise SourceError(
                f"{self.request.shown}: give zmq+tcp://HOST:PORT, such as zmq+tcp://127.0.0.1:5570"
            )
        return parts[0]

    def _bound(self, endpoint: str) -> zmq.SyncSocket:
        """Raises SourceError."""
        socket: zmq.SyncSocket = self._context.socket(zmq.ROUTER)
        socket.rcvhwm = QUEUE_MESSAGES
        socket.maxmsgsize = MOST_BYTES
        socket.ipv6 = "[" in endpoint
        until_s = time.monotonic() + LET_GO_S
        while True:
            try:
                socket.bind(endpoint)
            except zmq.ZMQError as error:
                if time.monotonic() < until_s and not self.stop.wait(RETRY_S):
                    continue
                self._context.destroy(0)
                reason = os.strerror(error.errno or 0)
                raise SourceError(
                    f"{self.request.shown}: {reason}: end the program that has it, or choose another port"
                ) from None
            return socket

    def _newest(self) -> Frame | None:
        """The next frame; one that nobody waits for gives way to what has come since. None: none was good."""
        newest: _Message | None = None
        begin, missed, before = False, 0, self._last
        for _ in range(MOST_IN_A_ROW):
            message = self._receive()
            if message is not None:
                if newest is not None:
                    self._answer(newest.answer_to, "dropped", NEWER)
                    missed += 1
                before, self._last = self._last, (message.header.t_us, message.size)
                newest, begin = message, begin or message.header.begin
            if (newest is not None and newest.header.wait) or not self._socket.poll(0):
                break
        if newest is None:
            return None
        try:
            return self._frame(newest, begin, missed)
        except PacketError as error:
            self._last = before
            self._answer(newest.answer_to, "refused", str(error))
            return None

    def _frame(self, message: _Message, begin: bool, missed: int) -> Frame:
        """Raises PacketError for an image that is damaged."""
        under_way = message.answer_to
        image = image_of(message.header, message.data)
        self._under_way.append(under_way)
        self.granted["width"], self.granted["height"] = message.size
        self.granted["pixel_format"] = message.header.encoding
        self._look_at(image)
        sent = Sent(under_way.wait, missed, lambda outcome: self._outcomes.put((under_way, outcome)))
        return Frame(image, message.header.t_us, cut=begin, sent=sent, gamma=self.gamma)

    def _receive(self) -> _Message | None:
        """The next message, in order; None where it was refused."""
        sender, *parts = self._socket.recv_multipart(copy=False)
        answer_to = _UnderWay([sender.bytes], None, False)
        if parts and not len(parts[0]):  # of a REQ socket
            answer_to = replace(answer_to, envelope=[sender.bytes, b""])
            del parts[0]
        try:
            if len(parts) != 2:
                raise PacketError(f"a message of {len(parts)} parts: send two, header and image")
            header = decode_header(bytes(parts[0].buffer[: HEADER_BYTES + 1]))
            answer_to = replace(answer_to, t_us=header.t_us, wait=header.wait)
            size = size_of(header, parts[1].buffer)
            if not header.begin:
                self._check_order(header.t_us, size)
        except PacketError as error:
            self._answer(answer_to, "refused", str(error))
            return None
        return _Message(answer_to, header, parts[1].buffer, size)

    def _check_order(self, t_us: int, size: tuple[int, int]) -> None:
        """Raises PacketError for a frame that cannot follow the last one."""
        last_us, (width, height) = self._last or (-1, size)
        begin = "send begin: true with the first frame of another run"
        if t_us <= last_us:
            raise PacketError(f"t_us is {t_us}, not later than {last_us} of the frame before; {begin}")
        if size != (width, height):
            raise PacketError(f"{size[0]} x {size[1]} pixels after {width} x {height}; {begin}")

    def _tell(self, wait_s: float) -> None:
        """Answer the frames whose outcome is known; wait so long for one."""
        with contextlib.suppress(queue.Empty):
            under_way, outcome = self._outcomes.get(wait_s > 0, wait_s)
            while True:
                self._under_way.remove(under_way)
                self._answer(under_way, outcome.result, outcome.reason, outcome.shift_us)
                under_way, outcome = self._outcomes.get(False)

    def _answer(self, to: _UnderWay, result: Result, reason: str, shift_us: int = 0) -> None:
        """To a sender that has left, it goes nowhere."""
        answer = Answer(t_us=to.t_us, result=result, reason=reason, shift_us=shift_us)
        self._socket.send_multipart([*to.envelope, encode_answer(answer)], zmq.NOBLOCK)
