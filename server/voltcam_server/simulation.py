"""From frames to intervals of events: the simulator, its parameters as they change, and one time line."""

import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import EVENT, Camera, Law, Parameters, Simulator
from voltcam_simulator.simulator import LONGEST_INTERVAL_US
from voltcam_video import Image, fit

from .mailbox import Arrival
from .problems import one_line

PATIENCE_FRAMES = 10  # so many stamps in a row that do not advance mean that the source's clock was set back
FIRST_PERIOD_US = 33_333


@dataclass(frozen=True, slots=True, eq=False)
class Interval:
    """The time between two frames: its events, sorted by t, and the frame (height, width) at its end.

    arrived_s: when that frame came, ready_s: when its events were known, `time.monotonic()`.
    paced: as of an Arrival.
    """

    events: NDArray[np.void]
    start_us: int
    end_us: int
    image: Image
    parameters_version: int
    arrived_s: float
    ready_s: float
    paced: bool

    @property
    def image_u8(self) -> NDArray[np.uint8]:
        """The frame as a viewer wants it."""
        return np.clip(np.rint(self.image), 0, 255).astype(np.uint8)


class Simulation:
    """A camera fed frame by frame; `change` may be called from any thread.

    Times run on across cuts and changes of source: a frame that starts again at an earlier time is moved to
    one frame period after the last one, and those after it likewise.
    """

    def __init__(self, camera: Camera, law: Law, seed: int) -> None:
        self.camera = camera
        self.simulated = 0
        self.out_of_order = 0
        self.unusable = 0
        self.fault = ""  # why the last unusable frame was one
        _compile(camera.parameters, law)
        self._simulator = Simulator(camera.width, camera.height, camera.parameters, law, seed)
        self._lock = threading.Lock()
        self._wanted = (camera.parameters, 0)
        self._version = 0
        self._last_us: int | None = None
        self._shift_us = 0
        self._period_us = FIRST_PERIOD_US
        self._stuck = 0

    @property
    def parameters(self) -> tuple[Parameters, int]:
        """The newest parameters and their version; they hold from the next interval on."""
        with self._lock:
            return self._wanted

    def change(self, changes: Mapping[str, Any]) -> tuple[Parameters, int]:
        """Change parameters, all at once, from the next interval on; returns them and their version.

        Raises pydantic.ValidationError, with nothing changed.
        """
        with self._lock:
            parameters, version = self._wanted
            self._wanted = parameters.changed(changes), version + 1
            return self._wanted

    def step(self, arrival: Arrival) -> Interval | None:
        """The interval that this frame ends; None for a frame that cannot be used, which is counted."""
        t_us = arrival.frame.t_us + self._shift_us
        span_us = 0 if self._last_us is None else t_us - self._last_us
        cut = arrival.cut or self._last_us is None or span_us > LONGEST_INTERVAL_US
        if not cut and span_us <= 0:
            self._stuck += 1
            if self._stuck <= PATIENCE_FRAMES:
                self.out_of_order += 1
                return None
            cut = True
        image = fit(arrival.frame.image, self.camera.width, self.camera.height, arrival.fit)
        self._take_parameters()
        try:
            return self._cut(image, arrival) if cut else self._advance(image, t_us, span_us, arrival)
        except ValueError as error:  # grey levels that are none; the simulator has changed nothing
            self.unusable += 1
            self.fault = one_line(error)
            return None

    def _advance(self, image: Image, t_us: int, span_us: int, arrival: Arrival) -> Interval:
        events = self._simulator.advance(image, t_us)
        self._period_us = span_us
        return self._done(events, t_us - span_us, t_us, image, arrival)

    def _cut(self, image: Image, arrival: Arrival) -> Interval:
        """Go on from a frame that does not follow from the last one: no events for the change."""
        earliest_us = 0 if self._last_us is None else self._last_us + self._period_us
        shift_us = max(0, earliest_us - arrival.frame.t_us)
        t_us = arrival.frame.t_us + shift_us
        self._simulator.jump(image, t_us)
        self._shift_us = shift_us
        return self._done(np.empty(0, EVENT), t_us, t_us, image, arrival)

    def _done(
        self, events: NDArray[np.void], start_us: int, end_us: int, image: Image, arrival: Arrival
    ) -> Interval:
        self._last_us = end_us
        self._stuck = 0
        self.simulated += 1
        return Interval(
            events, start_us, end_us, image, self._version, arrival.at_s, time.monotonic(), arrival.paced
        )

    def _take_parameters(self) -> None:
        parameters, version = self.parameters
        if version != self._version:
            self._simulator.parameters = parameters
            self._version = version


def _compile(parameters: Parameters, law: Law) -> None:
    """Have the kernels compiled, so that the first frames need not wait seconds for it."""
    small = Simulator(2, 2, parameters, law)
    small.advance(np.zeros((2, 2), np.uint8), 0)
    small.advance(np.full((2, 2), 255, np.uint8), 10_000)
