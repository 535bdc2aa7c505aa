"""The frame at the end of an interval, as a viewer wants it."""

import numpy as np
import pytest

from voltcam_server.interval import Interval
from voltcam_simulator import EVENT, Parameters


def shown(image: np.ndarray) -> np.ndarray:
    interval = Interval(np.empty(0, EVENT), 0, 1, 1, image, Parameters(), 0, "advanced", 1.0, 0.0, 0.0, True)
    return interval.image_u8


@pytest.mark.parametrize(
    ("grey", "level"), [(0.0, 0), (0.49, 0), (0.51, 1), (254.6, 255), (300.0, 255), (-5.0, 0)]
)
def test_floats_are_rounded_and_held_in_eight_bits(grey: float, level: int) -> None:
    assert shown(np.full((2, 3), grey, np.float32)).tolist() == [[level] * 3] * 2


def test_grey_levels_stay_as_they_are() -> None:
    image = np.arange(256, dtype=np.uint8).reshape(16, 16)
    np.testing.assert_array_equal(shown(image), image)
