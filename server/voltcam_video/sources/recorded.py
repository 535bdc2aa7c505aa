"""Playing a recording: when each frame is due and which time it carries."""

import threading
from abc import abstractmethod
from collections.abc import Callable, Generator, Iterator
from dataclasses import replace

from voltcam_video.clock import Clock
from voltcam_video.frame import Frame
from voltcam_video.request import SourceRequest
from voltcam_video.sources.source import Source

LATE_US = 100_000
GIVEN_UP_US = 1_000_000  # further behind than when frames began to be left out: leaving them out is no help
DEFAULT_PERIOD_US = 33_333  # a recording of one frame, looped: nothing in it says how long the frame lasts


def play(
    take: Callable[[], Iterator[Frame]],
    *,
    loop: bool,
    realtime: bool,
    clock: Clock,
    stop: threading.Event,
    rig: str | None = None,
    start_us: int = 0,
) -> Generator[Frame, None, None]:
    """The frames of `take()`, strictly increasing in t_us, on one time line; `loop` takes it again and again,
    a last interval's time after its end.

    realtime: each at its due time, the first at once, stamped with the wall clock. A machine too slow for
    that plays slower rather than later and later: once LATE_US behind, the rest of the time line moves.
    rig: the name of a time line that others play on too. Who comes to it later begins where they are; who
    falls behind leaves frames out, as a camera would. start_us: the first turn begins so long after the first
    frame.
    """
    line = clock.line(rig)
    turn = line.turn
    due_us: int | None = None
    period_us = DEFAULT_PERIOD_US
    cut = False
    behind_us: int | None = None  # how late the first of the frames that are being left out was
    while True:
        former_us: int | None = None
        first_us: int | None = None
        for frame in take():
            first_us = frame.t_us if first_us is None else first_us
            if due_us is None and frame.t_us < first_us + start_us:
                continue
            if former_us is not None:
                period_us = frame.t_us - former_us
            elif due_us is not None:
                line.begin(turn, due_us + period_us - frame.t_us)
            else:
                line.begin(turn, clock.now_us() - frame.t_us if realtime else 0)
            former_us, due_us = frame.t_us, frame.t_us + line.shift_us(turn)
            if realtime:
                late_us = clock.now_us() - due_us
                if late_us > LATE_US:
                    behind_us = late_us if behind_us is None else behind_us
                    if line.shared and late_us < behind_us + GIVEN_UP_US:
                        continue
                    line.move(turn, late_us)
                    due_us += late_us
                behind_us = None
                if not clock.wait_until(due_us, stop):
                    return
            yield _moved(frame, due_us, cut, first_us)
            cut = False
        if not loop or first_us is None or (former_us is None and not start_us):
            return
        start_us = 0
        turn, cut = turn + 1, True


def _moved(frame: Frame, t_us: int, cut: bool, first_us: int) -> Frame:
    """The frame at its time on the time line, its events with it."""
    events = frame.events
    if events is not None and t_us != frame.t_us:
        events = events.copy()
        events["t"] += t_us - frame.t_us
    return replace(frame, t_us=t_us, cut=cut, events=events, position_us=frame.t_us - first_us)


class RecordedSource(Source):
    """A source with its own time line, played at the pace asked for."""

    live = False

    def __init__(self, request: SourceRequest, clock: Clock, stop: threading.Event) -> None:
        super().__init__(request, clock, stop)
        self._playing = play(
            self._take,
            loop=request.loop,
            realtime=request.pace == "realtime",
            clock=clock,
            stop=stop,
            rig=request.rig,
            start_us=round(1e6 * request.start_s),
        )

    @abstractmethod
    def _take(self) -> Iterator[Frame]:
        """All frames once from the start, strictly increasing in t_us. Raises SourceError."""

    def read(self) -> Frame | None:
        return next(self._playing, None)

    def close(self) -> None:
        self._playing.close()
