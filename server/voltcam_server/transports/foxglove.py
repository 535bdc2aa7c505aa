"""Foxglove: frames and a preview of events, by the WebSocket server of Foxglove's own SDK.

The SDK queues messages for each client, and drops the oldest of one that is too slow. It does not tell how
many.
"""

import time
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from voltcam_client.packet import TOPIC_EVENTS, TOPIC_FRAMES, FrameMessage, Packet

from ..messages import Message
from ..problems import UsageError, one_line
from .foxglove_preview import EventsPreview
from .transport import Transport, TransportStatus

OPTION = "--foxglove"
FRAMES, PREVIEW, RATE = "/image_raw", "/events/preview", "/events/rate"
RATE_SCHEMA = {"type": "object", "title": "EventRate", "properties": {"events_per_s": {"type": "number"}}}
PREVIEW_S = 1 / 30
CLIENT_MESSAGES = 16  # that wait for a client: half a second


class FoxgloveTransport(Transport):
    """Listens at HOST:PORT at once. Raises UsageError when that is not possible.

    Port 0 takes a free one. now: seconds, by which previews are at least PREVIEW_S apart.
    """

    name: ClassVar[str] = "foxglove"

    def __init__(
        self, address: str, camera: str, width: int, height: int, now: Callable[[], float] = time.monotonic
    ) -> None:
        super().__init__()
        self._foxglove = _library()
        self._camera, self._now = camera, now
        self._preview = EventsPreview(width, height)
        self._taken_s = -PREVIEW_S
        self._sent = self._lost = 0
        self._context = context = self._foxglove.Context()  # without it the server has no channels
        host, _, port = address.rpartition(":")
        try:
            self._server = self._foxglove.start_server(
                name=f"voltcam {camera}",
                host=host.strip("[]"),
                port=int(port),
                capabilities=[],
                context=context,
                message_backlog_size=CLIENT_MESSAGES,
            )
        except Exception as error:  # it has no class of its own
            reason = one_line(error)
            raise UsageError(f"{address}: {reason}: choose another HOST:PORT with {OPTION}") from None
        self.address = f"{host}:{self._server.port}"
        self._frames = self._foxglove.channels.RawImageChannel(FRAMES, context=context)
        self._previews = self._foxglove.channels.RawImageChannel(PREVIEW, context=context)
        self._rates = self._foxglove.Channel(RATE, schema=RATE_SCHEMA, context=context)

    @property
    def status(self) -> TransportStatus:
        """Sent are packets that are in a preview."""
        return TransportStatus(
            address=f"ws://{self.address}", packets_sent=self._sent, packets_dropped=self._lost
        )

    def _send(self, message: Message) -> None:
        if message.topic == TOPIC_EVENTS:
            self._send_events(message.content)
        if message.topic == TOPIC_FRAMES and self._frames.has_sinks():
            frame: FrameMessage = message.content
            self._frames.log(self._image(frame.image, frame.t_us), log_time=1000 * frame.t_us)

    def _send_events(self, packet: Packet) -> None:
        if not (self._previews.has_sinks() or self._rates.has_sinks()):
            return
        self._preview.add(packet)
        self._sent += 1
        if self._now() - self._taken_s < PREVIEW_S or not self._preview.span_us:
            return
        self._taken_s = self._now()
        image, events_per_s, t_us = self._preview.take()
        self._previews.log(self._image(image, t_us), log_time=1000 * t_us)
        self._rates.log({"events_per_s": events_per_s}, log_time=1000 * t_us)

    def _image(self, image: NDArray[np.uint8], t_us: int) -> Any:
        height, width = image.shape
        seconds, us = divmod(t_us, 1_000_000)
        return self._foxglove.messages.RawImage(
            timestamp=self._foxglove.messages.Timestamp(sec=seconds, nsec=1000 * us),
            frame_id=self._camera,
            width=width,
            height=height,
            encoding="mono8",
            step=width,
            data=image.tobytes(),
        )

    def _dropped(self, message: Message) -> None:
        self._lost += message.topic == TOPIC_EVENTS

    def _close(self) -> None:
        self._server.stop()


def _library() -> Any:
    """Foxglove's SDK. Raises UsageError, which says how to have it."""
    try:
        import foxglove
        import foxglove.channels
        import foxglove.messages
    except ImportError:
        raise UsageError(f"{OPTION} takes foxglove-sdk: pip install 'voltcam[foxglove]'") from None
    return foxglove
