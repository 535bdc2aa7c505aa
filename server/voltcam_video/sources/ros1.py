"""Images that a topic of ROS 1 gives, on the clock of who publishes them: `ros1:/camera/image_raw`.

ROS is not needed here: `voltcam_client.ros1` speaks its protocols. Nobody waits who publishes on a topic, so
that of frames that come faster than they are simulated the newest goes on.
"""

import struct
import threading
import uuid
from dataclasses import replace
from functools import partial

from voltcam_client.errors import PacketError
from voltcam_client.pushed_frame import MOST_BYTES
from voltcam_client.ros1 import RosError
from voltcam_client.ros1.names import Names
from voltcam_client.ros1.node import Node
from voltcam_client.ros1.subscription import Received
from voltcam_video.clock import Clock
from voltcam_video.frame import Frame
from voltcam_video.request import SourceRequest
from voltcam_video.sources.image_message import compressed_image, raw_image
from voltcam_video.sources.source import Source, SourceError
from voltcam_video.sources.topic_frames import Decoded, TopicFrames

RAW, COMPRESSED = "sensor_msgs/Image", "sensor_msgs/CompressedImage"
QUEUE_MESSAGES = 2
MOST_MESSAGE_BYTES = MOST_BYTES + (1 << 16)
POLL_S = 0.05


class Ros1Source(Source):
    """A subscriber of one topic, for as long as the roscore is there."""

    live = True
    endless = True
    expects = True

    def __init__(self, request: SourceRequest, clock: Clock, stop: threading.Event) -> None:
        super().__init__(request, clock, stop)
        self.granted = self._awaiting("ros1", "TCPROS")
        self._frames = TopicFrames(request.shown, self.granted)
        try:
            self._node = Node(Names.of(f"voltcam_{uuid.uuid4().hex[:8]}"))
        except RosError as error:
            raise SourceError(f"{request.shown}: {error}") from None
        try:
            topic, kinds = request.ros1_topic or "", (RAW, COMPRESSED)
            self._images = self._node.subscribe(topic, kinds, QUEUE_MESSAGES, MOST_MESSAGE_BYTES)
        except RosError as error:
            self._node.close()
            raise SourceError(f"{request.shown}: {error}") from None

    @classmethod
    def reads(cls, request: SourceRequest) -> bool:
        return request.ros1_topic is not None

    def read(self) -> Frame | None:
        """The next frame; None where `stop` is set first. Raises SourceError."""
        while not self.stop.is_set():
            try:
                self._node.check()
                got = self._images.receive(POLL_S)
                frame = None if got is None else self._frames.frame(partial(_decoded, got), got.dropped)
                if frame is not None:
                    self._look_at(frame.image)
                    return replace(frame, gamma=self.gamma)
            except RosError as error:
                raise SourceError(f"{self.request.shown}: {error}") from None
        return None

    def close(self) -> None:
        self._node.close()


def _decoded(received: Received) -> Decoded:
    """Raises PacketError."""
    body = memoryview(received.body)
    try:
        _, seconds, ns = struct.unpack_from("<III", body)
        t_us, (_, at) = 1_000_000 * seconds + ns // 1000, _text(body, 12)
        if received.kind == COMPRESSED:
            encoding, at = _text(body, at)
            return t_us, compressed_image(encoding, _data(body, at)), encoding
        height, width = struct.unpack_from("<II", body, at)
        encoding, at = _text(body, at + 8)
        is_bigendian, step = struct.unpack_from("<BI", body, at)
        image = raw_image(encoding, width, height, step, bool(is_bigendian), _data(body, at + 5))
        return t_us, image, encoding
    except struct.error:
        raise PacketError(f"{len(body)} bytes are no {received.kind}") from None


def _text(body: memoryview, at: int) -> tuple[str, int]:
    """A string, and where it ends. Raises struct.error."""
    text = _data(body, at, last=False)
    return bytes(text[:80]).decode(errors="replace"), at + 4 + len(text)


def _data(body: memoryview, at: int, last: bool = True) -> memoryview:
    """uint8[] or string. Raises struct.error."""
    (size,) = struct.unpack_from("<I", body, at)
    data = body[at + 4 : at + 4 + size]
    if len(data) != size or (last and at + 4 + size != len(body)):
        raise struct.error
    return data
