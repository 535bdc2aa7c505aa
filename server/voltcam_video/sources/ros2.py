"""Images that a topic of ROS 2 gives, on the clock of who publishes them: `ros2:/camera/image_raw`.

ROS is not needed here: Cyclone DDS is what speaks (the extra `ros2`). See `topic_frames` for who waits.
"""

import threading
from collections import deque
from dataclasses import replace

from voltcam_client.ros2 import Ros2Error, received
from voltcam_client.ros2.message_types import COMPRESSED_IMAGE, IMAGE
from voltcam_client.ros2.names import Ros2Place, topic_name
from voltcam_client.ros2.participant import TopicReader, join
from voltcam_video.clock import Clock
from voltcam_video.frame import Frame
from voltcam_video.request import SourceRequest
from voltcam_video.sources.image_message import compressed_image, raw_image
from voltcam_video.sources.source import Source, SourceError
from voltcam_video.sources.topic_frames import Decoded, TopicFrames

QUEUE_MESSAGES = 2
POLL_S = 0.05
LEAVE_S = 1.0
COMPRESSED = "/compressed"


class Ros2Source(Source):
    """A subscriber of one topic: of compressed images where its name ends so."""

    live = True
    endless = True
    expects = True

    def __init__(self, request: SourceRequest, clock: Clock, stop: threading.Event) -> None:
        super().__init__(request, clock, stop)
        self.granted = self._awaiting("ros2", "Cyclone DDS")
        self._frames = TopicFrames(request.shown, self.granted)
        self._decode = _decode_raw
        kind = IMAGE
        try:
            topic = topic_name(request.ros2_topic or "")
            if topic.endswith(COMPRESSED):
                kind, self._decode = COMPRESSED_IMAGE, _decode_compressed
            self._inbox = _Inbox(join(Ros2Place.of()).reader(topic, kind))
        except Ros2Error as error:
            raise SourceError(f"{request.shown}: {error}") from None

    @classmethod
    def reads(cls, request: SourceRequest) -> bool:
        return request.ros2_topic is not None

    def read(self) -> Frame | None:
        """The next frame; None where `stop` is set first. Raises SourceError."""
        while not self.stop.is_set():
            taken = self._inbox.take(POLL_S)
            if taken is not None:
                cdr, missed = taken
                frame = self._frames.frame(lambda cdr=cdr: self._decode(cdr), missed)  # type: ignore[misc]
                if frame is not None:
                    self._look_at(frame.image)
                    return replace(frame, gamma=self.gamma)
        return None

    def close(self) -> None:
        self._inbox.close()


class _Inbox:
    """The newest messages of a topic. A thread takes them as they come, so that those left out are known."""

    def __init__(self, reader: TopicReader) -> None:
        self._messages: deque[bytes] = deque()
        self._missed = 0
        self._changed, self._over = threading.Condition(), threading.Event()
        self._failure: Exception | None = None
        self._thread = threading.Thread(target=self._run, args=(reader,), name="voltcam-ros2-in", daemon=True)
        self._thread.start()

    def take(self, wait_s: float) -> tuple[bytes, int] | None:
        """The next message, and how many before it were lost or left out; None where none came in time."""
        with self._changed:
            if not self._changed.wait_for(lambda: self._messages or self._failure, wait_s):
                return None
            if self._failure is not None:
                raise self._failure
            missed, self._missed = self._missed, 0
            return self._messages.popleft(), missed

    def close(self) -> None:
        self._over.set()
        self._thread.join(LEAVE_S)

    def _run(self, reader: TopicReader) -> None:
        try:
            lost = reader.lost
            while not self._over.is_set():
                came = reader.take(POLL_S)
                former, lost = lost, reader.lost
                with self._changed:
                    self._missed += lost - former
                    self._messages += came
                    while len(self._messages) > QUEUE_MESSAGES:
                        self._messages.popleft()
                        self._missed += 1
                    self._changed.notify_all()
        except Exception as error:  # one of DDS': the source is to be opened again
            with self._changed:
                self._failure = SourceError(str(error))
                self._changed.notify_all()


def _decode_raw(cdr: bytes) -> Decoded:
    """Raises PacketError."""
    got = received.image(cdr)
    image = raw_image(got.encoding, got.width, got.height, got.step, got.is_bigendian, got.data)
    return got.t_us, image, got.encoding


def _decode_compressed(cdr: bytes) -> Decoded:
    """Raises PacketError."""
    got = received.compressed_image(cdr)
    return got.t_us, compressed_image(got.encoding, got.data), got.encoding
