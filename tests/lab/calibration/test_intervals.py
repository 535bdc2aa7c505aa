"""Intervals of pixels whose light and events are written down."""

import numpy as np
import pytest

from voltcam_client.encodings import EVENT
from voltcam_lab.calibration.intervals import intervals
from voltcam_lab.light.scene import Scene, scene_of
from voltcam_lab.windows import Mask

PERIOD_US = 10_000


def ramp(frames: int = 11, height: int = 3, slope_dn: float = 4.0) -> Scene:
    """Light that rises by slope_dn a frame everywhere: any way of going between frames is straight."""
    t_us = PERIOD_US * np.arange(frames, dtype=np.int64)
    images = np.tile((100 + slope_dn * np.arange(frames, dtype=np.float32))[:, None, None], (1, height, 2))
    return scene_of(images, t_us, "linear")


def events(*rows: tuple[int, int, int, bool]) -> np.ndarray:
    return np.array(sorted(rows), EVENT)


EVERYWHERE = np.ones((3, 2), np.bool_)
NEVER = np.zeros((0, 2), np.int64)


def test_an_interval_has_the_light_along_it() -> None:
    seen = intervals(events((15_000, 0, 0, True), (45_000, 0, 0, False)), ramp(), EVERYWHERE, NEVER)
    first, last = seen
    assert (first["start_us"], first["end_us"], first["end"], first["start"]) == (15_000, 45_000, -1, 1)
    assert (first["before"], first["after"], first["mean"]) == pytest.approx((106, 118, 112))
    assert first["slope"] == pytest.approx(4e-4)
    assert (last["start_us"], last["end_us"], last["end"]) == (45_000, 100_000, 0)  # to the end of the scene


def test_what_passes_in_the_dead_time_is_lost_and_late_events_saw_earlier_light() -> None:
    two = events((15_000, 0, 0, True), (45_000, 0, 0, True))
    held = intervals(two, ramp(), EVERYWHERE, NEVER, dead_us=5000)[0]
    late = intervals(two, ramp(), EVERYWHERE, NEVER, delay_us=5000)[0]
    assert (held["before"], held["after"]) == pytest.approx((108, 118))
    assert (late["before"], late["after"]) == pytest.approx((104, 116))


def test_a_mask_ends_an_interval_unseen_and_begins_none() -> None:
    three = events((15_000, 0, 0, True), (45_000, 0, 0, True), (62_000, 0, 0, True))
    masked = np.array([[40_000, 50_000]])
    seen = intervals(three, ramp(), EVERYWHERE, masked)
    assert seen["start_us"].tolist() == [15_000, 62_000]
    assert (seen[0]["end_us"], seen[0]["end"]) == (40_000, 0)


def test_rows_are_masked_in_turn() -> None:
    rows = [(t, 0, y, True) for y in range(3) for t in (15_000, 45_000)]
    mask = Mask(row_windows=np.array([[44_000, 46_000]]), us_per_row=1500.0)
    seen = intervals(events(*rows), ramp(), EVERYWHERE, mask)
    first = {int(one["pixel"]) // 2: int(one["end"]) for one in seen if one["start_us"] == 15_000}
    assert first == {0: 0, 1: 1, 2: 1}  # 44 to 46 ms, 45.5 to 47.5, 47 to 49
    late = Mask(row_windows=np.array([[43_000, 44_000]]), us_per_row=1500.0)
    seen = intervals(events(*rows), ramp(), EVERYWHERE, late)
    assert [int(one["end"]) for one in seen if one["start_us"] == 15_000] == [1, 0, 1]
    assert late.share(0, 100_000) == pytest.approx(0.01)


def test_large_time_stamps_stay_exact() -> None:
    """An event outside every mask keeps its time to the bit, though rows' delays have fractions."""
    t_us = np.array([1_589_163_147_365_215, 1_589_163_147_365_216], np.float64)
    mask = Mask(row_windows=np.array([[0, 10]]), us_per_row=35.3365)
    assert (mask.start(t_us, np.array([17, 251])) == t_us).all()


def test_where_a_frame_surprises_no_interval_is_trusted() -> None:
    scene = ramp()
    images = scene.taken.copy()
    images[5] += 60
    jumpy = scene_of(images, scene.taken_us, "linear")
    three = events((15_000, 0, 0, True), (52_000, 0, 0, True), (85_000, 0, 0, True))
    seen = intervals(three, jumpy, EVERYWHERE, NEVER)
    assert seen["start_us"].tolist() == [15_000, 85_000]
    assert seen[0]["end"] == 0
    assert len(intervals(three, jumpy, EVERYWHERE, NEVER, tolerance=9.0)) == 3
