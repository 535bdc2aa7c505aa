"""Frames of a topic's images, on the clock of who publishes them.

Nobody waits who publishes on a topic. Of images that come faster than they are simulated the newest go on,
and the others are counted.
"""

from collections.abc import Callable

from voltcam_client.errors import PacketError
from voltcam_video.frame import Frame, Image, Sent
from voltcam_video.sources.source import Granted, SourceError

BAD_LIMIT = 30  # in a row
Decoded = tuple[int, Image, str]
"""Time in us, luminance and encoding."""


class TopicFrames:
    """shown: the source, for messages. granted: has the size and the encoding of the last frame."""

    def __init__(self, shown: str, granted: Granted) -> None:
        self._shown, self._granted = shown, granted
        self._last: tuple[int, tuple[int, ...]] | None = None  # time and shape of the last frame
        self._missed = self._bad = 0

    def frame(self, decode: Callable[[], Decoded], missed: int) -> Frame | None:
        """The next one. None for a message that is none, which counts as missed.

        missed: messages before it that were lost. decode: may raise PacketError. Raises SourceError for the
        first message of all where it is none, and for the last of many in a row.
        """
        self._missed += missed
        try:
            t_us, image, encoding = decode()
            if self._last is not None and t_us == self._last[0]:
                raise PacketError(f"two images at {t_us} us: does its publisher set header.stamp?")
        except PacketError as error:
            self._bad += 1
            self._missed += 1
            if self._last is None or self._bad == BAD_LIMIT:
                raise SourceError(f"{self._shown}: {error}") from None
            return None
        # A simulator that was reset begins at an earlier time.
        begin = self._last is not None and (t_us < self._last[0] or image.shape != self._last[1])
        self._last, self._bad = (t_us, image.shape), 0
        self._granted["height"], self._granted["width"] = image.shape
        self._granted["pixel_format"] = encoding
        missed, self._missed = self._missed, 0
        return Frame(image, t_us, cut=begin, sent=Sent(False, missed, lambda _: None))
