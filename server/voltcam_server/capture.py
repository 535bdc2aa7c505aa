"""The capture thread: from a source into the mailbox."""

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from voltcam_video import Clock, Granted, SourceError, SourceRequest, SourceState, watch

from .mailbox import Arrival, Mailbox
from .problems import one_line
from .replay_source import open_any

OPEN_S = 30.0  # a stream may take a while, a hanging one for ever
LEAVE_S = 2.0


class Capture:
    """One source, watched until it ends or `stop`.

    Its frames go nowhere before `go`, so that a new source is known to work before the former one is let go.
    granted: of a source that ran before, which is opened again for ever.
    """

    def __init__(
        self,
        request: SourceRequest,
        mailbox: Mailbox,
        on_state: Callable[[], None],
        granted: Granted | None = None,
        clock: Clock | None = None,
    ) -> None:
        self.request = request
        self._clock = clock
        self.state = SourceState("opening", granted=granted)
        self._mailbox = mailbox
        self._on_state = on_state
        self._stop, self._go, self._decided = threading.Event(), threading.Event(), threading.Event()
        self._opened = False
        self.position_us: int | None = None  # in a recording
        self._thread = threading.Thread(target=self._run, name="voltcam-capture", daemon=True)

    def start(self) -> None:
        """Open the source; again does no harm."""
        if self._thread.ident is None:
            self._thread.start()

    def wait_open(self) -> None:
        """Wait for the first frame, or for the source to wait for it. Raises SourceError when there will be
        none, or none within OPEN_S."""
        if not self._decided.wait(OPEN_S):
            raise SourceError(f"{self.request.shown}: no frame within {OPEN_S:g} s: check that it is sending")
        if not self._opened:
            raise SourceError(self.state.message or f"{self.request.shown}: holds no frame")

    def go(self) -> None:
        """Let the frames through."""
        self._go.set()

    def stop(self) -> None:
        """Let the source go."""
        self._stop.set()
        self._go.set()
        self._mailbox.wake()
        if self._thread.ident is not None:
            self._thread.join(LEAVE_S)

    def _run(self) -> None:
        try:
            given, first = (self.state.granted, self._clock, open_any), True
            for frame in watch(self.request, self._stop, self._set_state, *given):
                at_s = time.monotonic()
                self.position_us = frame.position_us
                self._opened = True
                self._decided.set()
                self._go.wait()
                missed = frame.sent.missed if frame.sent else 0
                cut, paced = frame.cut or first, self._paced
                arrival = Arrival(frame, self.request.fit, at_s, cut=cut, paced=paced, missed=missed)
                self._mailbox.put(arrival, self._stop)
                first = False
        except Exception as error:  # a source that fails is said in the status, and does not end the daemon
            name = "" if isinstance(error, SourceError) else f"{self.request.shown}: "
            self._set_state(replace(self.state, state="ended", message=name + one_line(error)))
        finally:
            self._decided.set()

    def has(self, request: SourceRequest) -> bool:
        """Whether this is that camera, or listens there: it cannot be opened a second time."""
        device, ours = request.device, self.request.device
        if request.inlet is not None:
            return request.inlet == self.request.inlet
        if device is None or ours is None or self.state.state != "running":
            return False
        return Path(device).resolve() == Path(ours).resolve()

    @property
    def _paced(self) -> bool:
        if self.state.granted and self.state.granted["clock"] == "sender":
            return False
        return self.request.pace == "realtime" or bool(self.state.granted and self.state.granted["live"])

    def _set_state(self, state: SourceState) -> None:
        self.state = state
        if state.state == "waiting":
            self._opened = True
            self._decided.set()
        self._on_state()
