"""Two cameras that look at one scene, into one recording: the frames of the one, the events of the other.

A process of its own that `runner` starts: `python -m voltcam_server.diagnosis.gather HERE REFERENCE FILE
SECONDS`. It costs the daemon what any subscriber does. On standard output it says figures (a JSON object a
line) and sentences; what goes wrong is one line on standard error, and exit status 1.
"""

import sys
import time
from collections import deque
from collections.abc import Callable, Iterator
from itertools import islice

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

from voltcam_client import EventCamera, FrameMessage, Packet, VoltcamError
from voltcam_client.camera import Message, Stream
from voltcam_client.formats import Writer, open_writer
from voltcam_simulator.effects.input_response import InputResponse

from ..problems import one_line

PATIENCE_S = 5.0  # with a camera of which nothing comes
CLOCK_S = 60.0  # how late a live camera may be, on an overloaded machine
TICK_S = 0.02  # the longest wait for one camera before the other is looked at
TURN = 50  # the most messages of one before the others have theirs
QUEUE_FRAMES = 300
SHOW_PERIOD_S = 0.5
WINDOW = 4  # showings that a rolling rate is the mean of
STRATA, PIXELS = 4, 256  # of the sample: levels of brightness, pixels of each


class PixelRates(BaseModel):
    """Events of a pixel."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    on: float
    """1/s"""

    off: float
    """1/s"""


class BrightnessRates(BaseModel):
    """Pixels of one level of brightness, as they were in the first frame."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    from_dn: int
    """grey level of the darkest"""

    to_dn: int
    """grey level of the brightest"""

    here: PixelRates
    """of this camera, over the last two seconds"""

    reference: PixelRates
    """of the reference, over the last two seconds"""


class Figures(BaseModel):
    """What has come so far."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    seconds: float
    """of both, s"""

    frames: int
    """of this camera"""

    events: int
    """of the reference"""

    strata: list[BrightnessRates]
    """from dark to bright"""


class Sample:
    """Counts events on pixels drawn alike from dark to bright ones of `image` (H, W)."""

    def __init__(self, image: NDArray[np.uint8]) -> None:
        level = image.ravel().astype(np.int64)
        self._stratum = np.full(level.size, STRATA)
        self._width = image.shape[1]
        self._limits: list[tuple[int, int, int]] = []
        rng = np.random.default_rng(0)
        for i, pixels in enumerate(np.array_split(np.argsort(level, kind="stable"), STRATA)):
            drawn = rng.permutation(pixels)[:PIXELS]
            self._stratum[drawn] = i
            self._limits.append((int(level[pixels[0]]), int(level[pixels[-1]]), drawn.size))
        self._counts = np.zeros((2, STRATA + 1, 2))
        self._window: deque[tuple[float, NDArray[np.float64]]] = deque(maxlen=WINDOW)
        self._ticked_s = time.monotonic()

    def count(self, camera: int, events: NDArray[np.void]) -> None:
        """camera: 0 here, 1 the reference."""
        stratum = self._stratum[events["y"].astype(np.int64) * self._width + events["x"]]
        found = np.bincount(2 * stratum + events["p"], minlength=2 * STRATA + 2)
        self._counts[camera] += found.reshape(-1, 2)

    def tick(self) -> list[BrightnessRates]:
        """The rates over the last few ticks."""
        now_s = time.monotonic()
        self._window.append((now_s - self._ticked_s, self._counts))
        self._ticked_s, self._counts = now_s, np.zeros_like(self._counts)
        seconds = sum(span for span, _ in self._window)
        per_s = np.sum([counts for _, counts in self._window], axis=0) / max(seconds, 1e-3)
        return [
            BrightnessRates(
                from_dn=low, to_dn=high, here=_rates(per_s[0, i] / n), reference=_rates(per_s[1, i] / n)
            )
            for i, (low, high, n) in enumerate(self._limits)
        ]


def gather(
    here: str, reference: str, path: str, seconds: float, show: Callable[[Figures], None]
) -> tuple[Figures, int]:
    """Record `seconds` of the cameras' clock into `path`; returns what came, and how many frames and packets
    did not.

    Raises VoltcamError where a camera does not answer, the two are of different sizes or on different clocks;
    OSError and ValueError as a Writer does.
    """
    with (
        EventCamera(here) as ours,
        EventCamera(reference) as theirs,
        ours.frames(queue_length=QUEUE_FRAMES) as frames,
    ):
        frame, packet = _first(frames), _first(theirs)
        _check(here, frame, reference, packet)
        with open_writer(path, width=packet.width, height=packet.height) as writer:
            gathered = _Gathered(writer, Sample(frame.image), frame.t_us, frame.t_us + round(seconds * 1e6))
            shown_s = heard_s = time.monotonic()
            reached_us = frame.t_us
            while not gathered.all:
                for packet in islice(_come(theirs, TICK_S), TURN):
                    gathered.packet(packet)
                for own in islice(_come(ours), TURN):
                    gathered.sample.count(0, own.events)
                for frame in islice(_come(frames), TURN):
                    gathered.frame(frame)
                now_s = time.monotonic()
                if now_s - shown_s >= SHOW_PERIOD_S:
                    show(gathered.figures)
                    shown_s = now_s
                if gathered.reached_us > reached_us:
                    reached_us, heard_s = gathered.reached_us, now_s
                if now_s - heard_s > PATIENCE_S:
                    raise VoltcamError(f"{gathered.late(here, reference)} fell silent: is it still running?")
            figures = gathered.figures
            show(figures)
        return figures, frames.lost_packets + theirs.lost_packets


class _Gathered:
    """What has come of both cameras, on the way from begin_us to end_us of their clock."""

    def __init__(self, writer: Writer, sample: Sample, begin_us: int, end_us: int) -> None:
        self.sample = sample
        self._writer = writer
        self._begin_us, self._end_us = begin_us, end_us
        self._frames = 0
        self._frames_us = self._events_us = begin_us  # how far each has come

    def frame(self, frame: FrameMessage) -> None:
        light = InputResponse(gamma_exponent=frame.gamma).light_of(frame.image)
        self._writer.frame(np.rint(light).astype(np.uint8), frame.t_us)
        self._frames += 1
        self._frames_us = frame.t_us

    def packet(self, packet: Packet) -> None:
        self._writer.events(packet.events)
        self.sample.count(1, packet.events)
        self._events_us = packet.time_base_ns // 1000

    @property
    def reached_us(self) -> int:
        """How far both have come."""
        return min(self._frames_us, self._events_us)

    @property
    def all(self) -> bool:
        return self.reached_us >= self._end_us

    def late(self, here: str, reference: str) -> str:
        """Whichever of the two is behind."""
        return here if self._frames_us < self._events_us else reference

    @property
    def figures(self) -> Figures:
        """With the rates since they were last asked for, and shortly before."""
        return Figures(
            seconds=round((self._frames_us - self._begin_us) / 1e6, 2),
            frames=self._frames,
            events=self._writer.event_count,
            strata=self.sample.tick(),
        )


def _come(stream: Stream[Message], timeout_s: float = 0) -> Iterator[Message]:
    """What has come, the first waited for."""
    while (message := stream.receive(timeout_s)) is not None:
        yield message
        timeout_s = 0


def _first(stream: Stream[Message]) -> Message:
    message = stream.receive(PATIENCE_S)
    if message is None:
        raise VoltcamError(f"nothing came from {stream.url} for {PATIENCE_S:g} s: is a camera running there?")
    return message


def _check(here: str, frame: FrameMessage, reference: str, packet: Packet) -> None:
    height, width = frame.image.shape
    if (packet.width, packet.height) != (width, height):
        raise VoltcamError(
            f"the camera at {reference} has {packet.width}x{packet.height} pixels, "
            f"this one {width}x{height}: start the daemon with a camera file of that size"
        )
    for url, t_us in ((here, frame.t_us), (reference, packet.time_base_ns // 1000)):
        off_s = t_us / 1e6 - time.time()
        if abs(off_s) > CLOCK_S:
            raise VoltcamError(
                f"the times of {url} are {off_s:.4g} s off this host's clock: "
                "both cameras must look at something live, on hosts with one clock"
            )


def _rates(per_s: NDArray[np.float64]) -> PixelRates:
    return PixelRates(off=round(float(per_s[0]), 4), on=round(float(per_s[1]), 4))


def _say(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


def main(arguments: list[str]) -> int:
    """The process."""
    here, reference, path, seconds = arguments
    _say(f"Gathering {seconds} s: frames from {here}, events from {reference}.")
    try:
        figures, lost = gather(
            here, reference, path, float(seconds), lambda shown: _say(shown.model_dump_json())
        )
    except (OSError, ValueError) as error:
        sys.stderr.write(f"voltcam: {one_line(error)}\n")
        return 1
    missing = f"; {lost} frames or packets were lost on the way" if lost else ""
    _say(f"Gathered {figures.frames} frames and {figures.events} events{missing}.")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
