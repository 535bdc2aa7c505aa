"""Frames in memory as a source."""

import numpy as np
import pytest

from voltcam_video import SourceError, SourceRequest
from voltcam_video.sources import MemorySource

REQUEST = SourceRequest(uri="walk.aedat4", pace="fast")
IMAGES = np.arange(24, dtype=np.uint8).reshape(2, 3, 4)


def test_every_frame_at_its_time() -> None:
    with MemorySource(REQUEST, IMAGES, np.array([500, 20_500])) as source:
        assert (source.granted["width"], source.granted["height"], source.granted["frames"]) == (4, 3, 2)
        assert source.granted["fps"] == 50
        frames = list(source)
    assert [frame.t_us for frame in frames] == [500, 20_500]
    for frame, image in zip(frames, IMAGES, strict=True):
        np.testing.assert_array_equal(frame.image, image)


def test_times_must_advance() -> None:
    with pytest.raises(
        SourceError, match=r"walk\.aedat4: frame 1 is at 500 us, not later than .* sort the frames"
    ):
        MemorySource(REQUEST, IMAGES, np.array([500, 500]))
