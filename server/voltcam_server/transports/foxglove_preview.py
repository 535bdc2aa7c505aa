"""Events as a picture: how often each pixel went up or down since the last one."""

import numpy as np
from numpy.typing import NDArray

from voltcam_client.packet import Packet

GREY, STEP = 128, 40  # of a pixel without events; for each event


class EventsPreview:
    """Adds up events, then gives them as an image (height, width): lighter is ON, darker is OFF."""

    def __init__(self, width: int, height: int) -> None:
        self._sum = np.zeros((height, width), np.int32)
        self._count = 0
        self._since_us = self._until_us = 0

    @property
    def span_us(self) -> int:
        """Of the events' clock, since the last image."""
        return self._until_us - self._since_us

    def add(self, packet: Packet) -> None:
        events = packet.events
        if events.size:
            np.add.at(self._sum, (events["y"], events["x"]), np.where(events["p"] > 0, 1, -1))
            self._count += events.size
        last_us = int(events["t"][-1]) if events.size else packet.time_base_ns // 1000
        self._until_us = max(self._until_us, last_us)

    def take(self) -> tuple[NDArray[np.uint8], float, int]:
        """Image, events per second and the time of the newest in us, since the last call; it begins anew."""
        image = np.clip(GREY + STEP * self._sum, 0, 255).astype(np.uint8)
        rate_per_s = self._count * 1e6 / max(self.span_us, 1)
        self._sum[:] = 0
        self._count = 0
        self._since_us = self._until_us
        return image, rate_per_s, self._until_us
