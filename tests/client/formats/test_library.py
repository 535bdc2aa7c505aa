"""Other people's readers: what they lack and what they complain of, in one line; their images in grey."""

from pathlib import Path

import numpy as np
import pytest

from voltcam_client.formats import FormatError
from voltcam_client.formats.library import grey, library, named, stacked

WALK = Path("walk.aedat4")


def test_a_library_that_is_missing_is_named_with_the_extra() -> None:
    assert library("json", WALK).loads("1") == 1
    with pytest.raises(FormatError, match=r"walk.aedat4: .*not_there.*voltcam\[lab\]"):
        library("not_there", WALK)


@pytest.mark.parametrize(
    ("error", "words"), [(RuntimeError("bad\nblock"), "(bad)"), (ValueError(), "(ValueError)")]
)
def test_a_complaint_is_one_line(error: Exception, words: str) -> None:
    with pytest.raises(FormatError) as caught, named(WALK, "AEDAT4 file"):
        raise error
    assert "no AEDAT4 file" in str(caught.value)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_the_disk_s_own_errors_go_on() -> None:
    with pytest.raises(FileNotFoundError), named(WALK, "AEDAT4 file"):
        raise FileNotFoundError


def test_grey_is_luminance_and_knows_the_order_of_channels() -> None:
    red = np.array([[[200, 0, 0]]], np.uint8)
    assert grey(red).tolist() == [[60]]  # 0.299 x 200, rounded
    assert grey(red, "BGR").tolist() == [[23]]  # 0.114 x 200
    assert grey(np.full((2, 3, 4), 77, np.uint8)).tolist() == [[77] * 3] * 2  # a fourth channel is opacity
    assert grey(np.array([[5]], np.uint8)).tolist() == [[5]]
    with pytest.raises(ValueError, match="8 bit"):
        grey(np.zeros((2, 2), np.uint16))


def test_frames_of_two_sizes_are_refused_by_number() -> None:
    small, wide = np.zeros((2, 3), np.uint8), np.zeros((2, 4), np.uint8)
    assert stacked([small, small], WALK).shape == (2, 2, 3)
    with pytest.raises(FormatError, match="frame 1 is 4x2, the first is 3x2"):
        stacked([small, wide], WALK)
