"""A recording played as a live camera: its own events, at its own pace, and nothing simulated."""

import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import Events
from voltcam_client.formats import FormatError, Recording, RecordingError, read
from voltcam_video import Clock, Frame, Image, Source, SourceError, SourceRequest, open_source
from voltcam_video.sources.recorded import RecordedSource
from voltcam_video.sources.source import Granted

SCHEME = "replay:"
PERIOD_US = 10_000  # of the empty frames of a recording without any
GREY = 128


def open_any(request: SourceRequest, clock: Clock, stop: threading.Event) -> Source:
    """As `voltcam_video.open_source`, and `replay:FILE`. Raises SourceError."""
    kind = ReplaySource if request.uri.startswith(SCHEME) else open_source
    return kind(request, clock, stop)


class ReplaySource(RecordedSource):
    """Frames of a recording, with the events up to each of them; those of no frame at its end go last."""

    def __init__(self, request: SourceRequest, clock: Clock, stop: threading.Event) -> None:
        super().__init__(request, clock, stop)
        try:
            self._recording = recording = read(Path(request.uri.removeprefix(SCHEME)))
        except (FormatError, RecordingError) as error:
            raise SourceError(str(error)) from None
        self._t_us = _frame_times_us(recording)
        if not self._t_us.size:
            raise SourceError(f"{request.shown}: holds neither events nor frames")
        self.granted = Granted(
            kind="replay",
            live=False,
            width=recording.width,
            height=recording.height,
            fps=float((self._t_us.size - 1) * 1e6 / np.ptp(self._t_us)) if self._t_us.size > 1 else None,
            pixel_format=None,
            frames=self._t_us.size,
            backend=None,
            clock="recording",
            levels=self.levels,
        )

    def _take(self) -> Iterator[Frame]:
        events = self._recording.events
        ends = np.searchsorted(np.ascontiguousarray(events["t"]), self._t_us, side="right")
        begin = 0
        for i, (t_us, end) in enumerate(zip(self._t_us.tolist(), ends.tolist(), strict=True)):
            yield Frame(self._image(i), t_us, events=events[begin:end])
            begin = end

    def _image(self, i: int) -> Image:
        frames = self._recording.frames
        if frames is not None and i < len(frames):
            return np.ascontiguousarray(frames[i])
        if frames is not None:
            return np.ascontiguousarray(frames[-1])
        return np.full((self._recording.height, self._recording.width), GREY, np.uint8)


def _frame_times_us(recording: Recording) -> NDArray[np.int64]:
    """When frames are; one more where events come after the last."""
    events: Events = recording.events
    if recording.frame_t_us is not None and recording.frame_t_us.size:
        times = recording.frame_t_us.astype(np.int64)
        if events.size and events["t"][-1] > times[-1]:
            times = np.append(times, events["t"][-1])
        return times
    if not events.size:
        return np.empty(0, np.int64)
    first, last = int(events["t"][0]), int(events["t"][-1])
    return np.arange(first, last + PERIOD_US, PERIOD_US, dtype=np.int64)
