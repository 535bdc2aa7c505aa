"""Windows and images of a clip."""

import numpy as np
import pytest

pytest.importorskip("torch", reason="PyTorch is not installed: pip install 'voltcam[learn]'")

from voltcam_lab.torch import ClipShape
from voltcam_lab.torch.clip import images_at
from voltcam_simulator import EVENT


def test_events_are_cut_into_windows_that_begin_at_0() -> None:
    events = np.array(
        [(0, 1, 1, True), (99, 2, 1, True), (100, 3, 1, False), (299, 4, 1, True), (300, 5, 1, True)], EVENT
    )
    shape = ClipShape(8, 8, 3, 100, "events", 5, 1.0)
    clip = shape.cut(events, np.zeros((3, 8, 8), np.float32))
    assert [each["t"].tolist() for each in clip.events] == [[0, 99], [0], [99]]
    assert events["t"].tolist() == [0, 99, 100, 299, 300]  # the caller's own are left alone


def test_images_lie_on_straight_lines_and_no_frame_is_taken_too_early() -> None:
    taken = []

    def frames() -> object:
        for t_us in (0, 10, 40, 100):
            taken.append(t_us)
            yield np.full((2, 2), t_us, np.uint8), t_us

    images = list(images_at([10, 25, 40], frames()))  # type: ignore[arg-type]
    assert [image[0, 0] for image in images] == [10, 25, 40]
    assert taken == [0, 10, 40]
    assert [image[0, 0] for image in images_at([30, 200], frames())] == [30]  # type: ignore[arg-type]
