"""What of a recording is fitted, of light and events that are written down."""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_client.encodings import EVENT
from voltcam_lab.calibration.reading import ENOUGH, Reading
from voltcam_lab.calibration.rest import NO_WAITS
from voltcam_lab.light.scene import TOLERANCES, scene_of
from voltcam_lab.windows import no_windows

SIDE, PERIOD_US, FRAMES = 12, 10_000, 101


def reading(per_pixel: int = 40, jump_dn: float = 0.0, on_share: float = 0.5) -> Reading:
    """Light rises by 0 to 14 DN in a second; each pixel has so many events; every fifth frame jumps."""
    light = np.linspace(0, 0.14, SIDE * SIDE).reshape(SIDE, SIDE)
    images = 100 + light * np.arange(FRAMES)[:, None, None]
    images[2::5] += jump_dn
    t_us = PERIOD_US * np.arange(FRAMES, dtype=np.int64)
    rng = np.random.default_rng(1)
    events = np.zeros(per_pixel * SIDE * SIDE, EVENT)
    pixel = np.repeat(np.arange(SIDE * SIDE), per_pixel)
    events["y"], events["x"] = np.divmod(pixel, SIDE)
    events["t"] = rng.integers(0, t_us[-1], len(events))
    events["p"] = rng.random(len(events)) < on_share
    scene = scene_of(images.astype(np.float32), t_us, "linear")
    return Reading(np.sort(events, order="t"), scene, np.ones((SIDE, SIDE), bool), no_windows())


@pytest.fixture(scope="module")
def plain() -> Reading:
    return reading()


def ends(one: Reading) -> np.ndarray:
    return one.intervals(0.0, 0.0)["end"]


def test_without_preparation_no_wait_counts(plain: Reading) -> None:
    assert plain.waits() is NO_WAITS
    prepared = plain.prepared()
    assert prepared.rest is not None
    some = np.zeros_like(plain.keep)
    some[:3] = True
    few = replace(prepared, resting=some)
    assert set(few.waits()["pixel"]) <= set(np.flatnonzero(some))
    assert 0 < few.waits()["count"].sum() <= prepared.waits()["count"].sum()


def test_light_that_suffices_is_trusted_strictly(plain: Reading) -> None:
    assert np.count_nonzero(ends(plain)) > ENOUGH
    assert plain.prepared().tolerance == TOLERANCES[0]


@pytest.mark.parametrize("jump_dn", [15.0, 40.0])
def test_no_more_light_is_trusted_than_leaves_enough(jump_dn: float) -> None:
    """Surprises of 12 and 28 % of the brightness."""
    jumpy = reading(jump_dn=jump_dn)
    found = jumpy.prepared()
    stricter = TOLERANCES[TOLERANCES.index(found.tolerance) - 1]
    assert found.tolerance > TOLERANCES[0]
    assert (
        np.count_nonzero(ends(found)) >= ENOUGH > np.count_nonzero(ends(replace(jumpy, tolerance=stricter)))
    )


def test_of_one_polarity_alone_there_is_never_enough() -> None:
    """Leak makes ON only, and tells nothing of thresholds: the last tolerance is taken."""
    assert reading(on_share=1.0).prepared().tolerance == TOLERANCES[-1]


def test_a_sample_has_as_many_intervals_of_each_third_as_asked(plain: Reading) -> None:
    """Pixels in the order of how much their light moves; no third has more, nor less by a pixel's own."""
    keep = np.ones((SIDE, SIDE), bool)
    keep[:, 0] = False
    found = replace(plain, keep=keep).sampled(np.random.default_rng(2), 1200, still=300)
    assert not found.keep[:, 0].any()
    seen = plain.intervals(0.0, 0.0)
    count = np.bincount(seen["pixel"][seen["end"] != 0], minlength=SIDE * SIDE)
    thirds = np.array_split(np.flatnonzero(keep), 3)  # light moves more from pixel to pixel
    for third, most in zip(thirds, (700, 400, 400), strict=True):
        got = count[third[found.keep.ravel()[third]]].sum()
        assert most - count.max() <= got <= most


def test_a_sample_larger_than_all_is_all(plain: Reading) -> None:
    found = plain.sampled(np.random.default_rng(3), 10**6)
    assert found.keep.all()
    assert len(ends(found)) == len(ends(plain))
