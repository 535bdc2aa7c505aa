"""Intervals and waits of pixels whose light and events are written down."""

import numpy as np
import pytest

from voltcam_client.encodings import EVENT
from voltcam_lab.calibration.intervals import intervals
from voltcam_lab.calibration.rest import WAIT, log_likelihood, rest_of, waits
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


def still(frames: int = 300) -> Scene:
    images = np.full((frames, 3, 2), 100, np.uint8)
    return scene_of(images, PERIOD_US * np.arange(frames, dtype=np.int64), "linear")


def test_waits_last_until_the_first_event() -> None:
    scene = still()
    mask = Mask(np.array([[1_000_000, 1_100_000]]))
    some = events(
        (500_000, 0, 0, True), (700_000, 0, 0, True), (900_000, 1, 0, False), (1_050_000, 0, 1, True)
    )
    found = waits(some, rest_of(scene), EVERYWHERE, mask)
    ended = {int(one["pixel"]): (float(one["wait_us"]), int(one["end"])) for one in found[:3]}
    assert ended == {0: (500_000, 1), 1: (900_000, -1), 2: (1_000_000, 0)}
    silent = found[3:]
    assert silent["count"].sum() == 3
    assert silent["wait_us"] == pytest.approx(2_990_000 - 100_000)


def test_waits_have_the_law_of_a_leak_and_of_noise() -> None:
    """What is lost of survival is what ends, by leak or noise, ON or OFF."""
    t_us = np.linspace(1e3, 6e6, 6000)
    found = np.zeros((3, t_us.size), WAIT)
    found["wait_us"], found["count"], found["end"] = t_us, 1, np.array([[0], [1], [-1]])
    leak, noise = np.full(t_us.size, 4e-7), np.full(t_us.size, 1e-7)
    alive, on, off = (np.exp(log_likelihood(row, leak, noise, 1.0)) for row in found)
    assert alive[0] == pytest.approx(1, abs=0.01)
    assert on + off == pytest.approx(-np.gradient(alive, t_us), rel=0.01, abs=1e-11)
    early = t_us < 1e6  # uniform and exponential, before the end of the uniform one
    assert alive[early] == pytest.approx(((1 - 4e-7 * t_us) * np.exp(-1e-7 * t_us))[early], abs=0.01)


def test_long_silence_speaks_against_leak_however_large() -> None:
    found = np.zeros(4, WAIT)
    found["wait_us"], found["count"] = 2e6, 1
    silent = log_likelihood(found, np.array([1e-8, 1e-7, 1e-6, 1e-5]), np.full(4, 1e-12), 1.0)
    assert (np.diff(silent) < -0.01).all()
