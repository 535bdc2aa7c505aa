"""What the baselines share: a sensor that is shown frames, and gives out events for what lies between."""

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import ArrayLike, NDArray

from voltcam_simulator import EVENT
from voltcam_simulator.effect import Events
from voltcam_simulator.event_key import unpack_events
from voltcam_simulator.key_order import in_rising_order

SMALLEST_THRESHOLD = 0.01
"""Where both published tools clip the thresholds they draw [ln units]."""

Plane = NDArray[np.float64]  # (pixels,)
Keys = NDArray[np.uint64]


class FramePixels(ABC):
    """width x height pixels that see frames of 0..255 DN."""

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        self._t_us: int | None = None

    def advance(self, image: ArrayLike, t_us: int) -> Events:
        """The events between the last image and this one, dtype EVENT, sorted by time.

        image: (height, width) [DN]; t_us: its time, later than the last one's. The first gives no events.
        Raises ValueError, with nothing changed, for a wrong shape or a time that does not advance.
        """
        light = np.asarray(image, np.float64)
        if light.shape != (self.height, self.width):
            raise ValueError(
                f"the image is {light.shape}, the sensor (height, width) = {(self.height, self.width)}"
            )
        if self._t_us is None:
            self._settle(light.ravel())
            self._t_us = t_us
            return np.empty(0, EVENT)
        start_us, span_us = self._t_us, t_us - self._t_us
        if span_us <= 0:
            raise ValueError(f"the image at {t_us} us does not come after the last one at {start_us} us")
        keys = in_rising_order(self._step(light.ravel(), start_us, span_us))
        self._t_us = t_us
        events = np.empty(keys.size, EVENT)
        unpack_events(keys, start_us, events)
        return events

    @abstractmethod
    def _settle(self, light: Plane) -> None:
        """The first image: what the pixels remember."""

    @abstractmethod
    def _step(self, light: Plane, start_us: int, span_us: int) -> Keys:
        """The events up to the next image, as event keys in any order."""


def mismatched(generator: np.random.Generator, theta: float, sigma: float, pixels: int) -> Plane:
    """A threshold per pixel, Gaussian, clipped as the published tools do."""
    return np.maximum(generator.normal(theta, sigma, pixels), SMALLEST_THRESHOLD)
