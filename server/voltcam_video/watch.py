"""Frames for as long as the daemon runs: a camera or stream that fails is opened again."""

import queue
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Literal

from voltcam_video.clock import Clock
from voltcam_video.frame import Frame
from voltcam_video.request import SourceRequest
from voltcam_video.sources import Granted, Source, SourceError, open_source

Opener = Callable[[SourceRequest, Clock, threading.Event], Source]
FIRST_DELAY_S, LONGEST_DELAY_S = 0.5, 10.0
POLL_S = 0.05
LEAVE_S = 0.15


@dataclass(frozen=True)
class SourceState:
    """How the source is; `granted` once it ran; attempts: failures in a row since its last frame.

    waiting: open, for a program that is to send the first frame.
    """

    state: Literal["opening", "waiting", "running", "reconnecting", "ended"]
    message: str = ""
    granted: Granted | None = None
    attempts: int = 0


def watch(
    request: SourceRequest,
    stop: threading.Event,
    on_state: Callable[[SourceState], None],
    granted: Granted | None = None,
    clock: Clock | None = None,
    open_with: Opener | None = None,
) -> Iterator[Frame]:
    """Opens the source and yields its frames until it ends or `stop` is set, which takes effect within 0.2 s.

    A live source that fails after its first frame, or while it waits for that, is opened again for ever,
    waiting 0.5 s to 10 s between attempts; its next frame has `cut` set. Another that fails before its first
    frame raises SourceError, as a recording that fails does. granted: what a source gave that ran before: it
    is opened again for ever, too.
    `on_state` is called at every change, by the thread that takes the frames or the one that reads. clock:
    shared by cameras whose frames are to be on one.
    """
    clock = clock or Clock()
    attempts, ran = 0, False
    on_state(SourceState("opening"))
    while not stop.is_set():
        clock.renew()
        reader = _Reader(request, clock, open_with or open_source, on_state)
        try:
            for frame in reader.frames(stop):
                if attempts or not ran:
                    granted = reader.granted
                    on_state(SourceState("running", granted=granted))
                    frame = replace(frame, cut=frame.cut or ran)
                    attempts, ran = 0, True
                yield frame
            break
        except SourceError as error:
            granted = granted or reader.waited_with
            if granted is None or not granted["live"]:
                on_state(SourceState("ended", str(error), granted))
                raise
            attempts += 1
            on_state(SourceState("reconnecting", str(error), granted, attempts))
        finally:
            reader.leave()
        stop.wait(min(FIRST_DELAY_S * 2 ** (attempts - 1), LONGEST_DELAY_S))
    on_state(SourceState("ended", "stopped" if stop.is_set() else "the end was reached", granted))


class _Reader:
    """Reads one source in a thread of its own, so that an open or a read that hangs holds nobody up.

    It is one frame ahead at most: a slow consumer slows it down, no frame is lost here.
    """

    def __init__(
        self,
        request: SourceRequest,
        clock: Clock,
        open_with: Opener,
        on_state: Callable[[SourceState], None],
    ) -> None:
        self.granted: Granted | None = None
        self.waited_with: Granted | None = None  # of a source that expects
        self._on_state = on_state
        self._items: queue.Queue[Frame | Exception | None] = queue.Queue(maxsize=1)
        self._left = threading.Event()
        self._thread = threading.Thread(
            target=self._run, args=(request, clock, open_with), name="voltcam-source", daemon=True
        )
        self._thread.start()

    def frames(self, stop: threading.Event) -> Iterator[Frame]:
        """The frames until the end or `stop`. Raises what the source raised."""
        while not stop.is_set():
            try:
                item = self._items.get(timeout=POLL_S)
            except queue.Empty:
                continue
            if item is None:
                return
            if isinstance(item, Exception):
                raise item
            yield item

    def leave(self) -> None:
        """Lets the source go; a hanging one closes itself when its own timeout ends."""
        self._left.set()
        self._thread.join(LEAVE_S)

    def _run(self, request: SourceRequest, clock: Clock, open_with: Opener) -> None:
        try:
            with open_with(request, clock, self._left) as source:
                self.granted = source.granted
                self.waited_with = source.granted if source.expects else None
                if source.expects and not self._left.is_set():
                    words = f"{request.shown}: waits for a program that sends frames"
                    self._on_state(SourceState("waiting", words))
                for frame in source:
                    self._put(frame)
                    if self._left.is_set():
                        return
            self._put(None)
        except Exception as error:
            self._put(error)

    def _put(self, item: Frame | Exception | None) -> None:
        while not self._left.is_set():
            try:
                self._items.put(item, timeout=POLL_S)
            except queue.Full:
                continue
            return
