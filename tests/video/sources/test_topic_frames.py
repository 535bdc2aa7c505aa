"""Frames of a topic: their order, where a run begins, what is left out."""

from collections.abc import Callable

import numpy as np
import pytest

from voltcam_client.errors import PacketError
from voltcam_video import SourceError
from voltcam_video.sources.source import Granted
from voltcam_video.sources.topic_frames import BAD_LIMIT, Decoded, TopicFrames


def granted() -> Granted:
    return Granted(
        kind="a topic",
        live=True,
        width=0,
        height=0,
        fps=None,
        pixel_format=None,
        frames=None,
        backend=None,
        clock="sender",
        levels="light",
    )


def image(t_us: int, width: int = 7) -> Callable[[], Decoded]:
    return lambda: (t_us, np.zeros((5, width), np.uint8), "mono8")


def bad() -> Decoded:
    raise PacketError("it is none")


def test_frames_follow_and_runs_begin() -> None:
    said = granted()
    frames = TopicFrames("ros2:/a", said)
    made = [
        frames.frame(each, 0) for each in (image(10), image(20), image(5), image(6), image(7, 9), image(8, 9))
    ]
    assert [frame.t_us for frame in made if frame] == [10, 20, 5, 6, 7, 8]
    assert [frame.cut for frame in made if frame] == [False, False, True, False, True, False]
    assert (said["width"], said["height"], said["pixel_format"]) == (9, 5, "mono8")


def test_what_is_lost_or_none_is_counted_at_the_next_frame() -> None:
    frames = TopicFrames("ros2:/a", granted())
    first = frames.frame(image(1), 3)
    assert frames.frame(bad, 2) is None
    assert frames.frame(image(1), 0) is None  # its time is that of the one before
    second = frames.frame(image(2), 1)
    assert first is not None
    assert second is not None
    assert first.sent is not None
    assert second.sent is not None
    assert (first.sent.missed, second.sent.missed) == (3, 5)
    assert not second.sent.wait


def test_a_first_image_that_is_none_is_said() -> None:
    with pytest.raises(SourceError, match="ros2:/a: it is none"):
        TopicFrames("ros2:/a", granted()).frame(bad, 0)


def test_many_in_a_row_are_said() -> None:
    frames = TopicFrames("ros2:/a", granted())
    frames.frame(image(1), 0)
    for _ in range(BAD_LIMIT - 1):
        assert frames.frame(bad, 0) is None
    with pytest.raises(SourceError, match="it is none"):
        frames.frame(bad, 0)
