"""The source that a camera looks at, and how another takes its place while the camera runs."""

import threading
from collections.abc import Callable

from voltcam_video import Clock, Granted, SourceError, SourceRequest, SourceState

from .capture import Capture
from .mailbox import Mailbox
from .problems import UsageError
from .status import SourceStatus


class CurrentSource:
    """`start` it, then `go`, then `stop`, once. on_news: is called when its state has changed."""

    def __init__(
        self, request: SourceRequest, mailbox: Mailbox, on_news: Callable[[], None], clock: Clock
    ) -> None:
        self._mailbox, self._on_news, self._clock = mailbox, on_news, clock
        self._capture = self._capture_of(request)
        self._opening: Capture | None = None
        self._looking = threading.Lock()  # held while a source is opened
        self._control = threading.Lock()  # one takes another's place at a time; held briefly
        self._stopping = False

    def start(self) -> None:
        """Open it. Raises SourceError; `stop` is due in any case."""
        self._capture.start()
        self._capture.wait_open()

    def go(self) -> None:
        """Let its frames through."""
        self._capture.go()

    def stop(self) -> None:
        """Let it go, and open no other."""
        self._stopping = True
        if opening := self._opening:  # a source that takes its time is not waited for
            opening.stop()
        with self._control:
            self._capture.stop()

    def look_at(self, request: SourceRequest) -> None:
        """As `Emulator.look_at`."""
        if not self._looking.acquire(blocking=False):
            raise UsageError("another source is being opened: wait until that is done")
        try:
            self._check_running()
            former = self._capture
            if request.uri == former.request.shown:  # as we told it: without the password
                request = request.model_copy(update={"uri": former.request.uri})
            self._use(self._opened(request, former))
        finally:
            self._looking.release()

    @property
    def shown(self) -> str:
        """Its address, without a password."""
        return self._capture.request.shown

    @property
    def state(self) -> SourceState:
        """How it is."""
        return self._capture.state

    def status(self, fps: float, fault: str) -> SourceStatus:
        """What was asked for, and how that is going. fps: of its frames. fault: of one of them, if any."""
        state, request = self._capture.state, self._capture.request
        return SourceStatus(
            uri=request.shown,
            request=request.model_copy(update={"uri": request.shown}),
            state=state.state,
            message=state.message or fault,
            granted=dict(state.granted) if state.granted else None,
            fps=fps,
            position_s=None if self._capture.position_us is None else self._capture.position_us / 1e6,
        )

    def _opened(self, request: SourceRequest, former: Capture) -> Capture:
        exclusive = former.has(request)
        if exclusive:
            former.stop()
        new = self._opening = self._capture_of(request)
        new.start()
        try:
            new.wait_open()
        except SourceError:
            new.stop()
            if exclusive:
                self._use(self._capture_of(former.request, former.state.granted))
            raise
        finally:
            self._opening = None
        return new

    def _capture_of(self, request: SourceRequest, granted: Granted | None = None) -> Capture:
        return Capture(request, self._mailbox, self._on_news, granted, self._clock)

    def _check_running(self) -> None:
        if self._stopping:
            raise UsageError("the daemon is ending: start it again")

    def _use(self, capture: Capture) -> None:
        with self._control:
            self._capture.stop()
            if self._stopping:
                capture.stop()
                return
            self._capture = capture
            capture.start()
            capture.go()
