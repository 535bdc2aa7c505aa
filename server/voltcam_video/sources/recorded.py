"""Playing a recording: when each frame is due and which time it carries."""

import threading
from abc import abstractmethod
from collections.abc import Callable, Generator, Iterator

from voltcam_video.clock import Clock
from voltcam_video.frame import Frame
from voltcam_video.request import SourceRequest
from voltcam_video.sources.source import Source

LATE_US = 100_000
DEFAULT_PERIOD_US = 33_333  # a recording of one frame, looped: nothing in it says how long the frame lasts


def play(
    take: Callable[[], Iterator[Frame]], *, loop: bool, realtime: bool, clock: Clock, stop: threading.Event
) -> Generator[Frame, None, None]:
    """The frames of `take()`, strictly increasing in t_us, on one time line; `loop` takes it again and again,
    a last interval's time after its end.

    realtime: each at its due time, the first at once, stamped with the wall clock. A machine too slow for
    that plays slower rather than later and later: once LATE_US behind, the rest of the time line moves.
    """
    due_us: int | None = None
    shift_us, period_us = 0, DEFAULT_PERIOD_US
    while True:
        former_us: int | None = None
        for frame in take():
            again = former_us is None and due_us is not None
            if due_us is None:
                shift_us = clock.now_us() - frame.t_us if realtime else 0
            elif former_us is None:
                shift_us = due_us + period_us - frame.t_us
            else:
                period_us = frame.t_us - former_us
            if realtime:
                late_us = clock.now_us() - (frame.t_us + shift_us)
                if late_us > LATE_US:
                    shift_us += late_us
                if not clock.wait_until(frame.t_us + shift_us, stop):
                    return
            former_us, due_us = frame.t_us, frame.t_us + shift_us
            yield Frame(frame.image, due_us, cut=again)
        if not loop or former_us is None:
            return


class RecordedSource(Source):
    """A source with its own time line, played at the pace asked for."""

    live = False

    def __init__(self, request: SourceRequest, clock: Clock, stop: threading.Event) -> None:
        super().__init__(request, clock, stop)
        self._playing = play(
            self._take, loop=request.loop, realtime=request.pace == "realtime", clock=clock, stop=stop
        )

    @abstractmethod
    def _take(self) -> Iterator[Frame]:
        """All frames once from the start, strictly increasing in t_us. Raises SourceError."""

    def read(self) -> Frame | None:
        return next(self._playing, None)

    def close(self) -> None:
        self._playing.close()
