"""How a scene is divided: blocks of time, tiles, and what each pixel goes through."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_lab.light.known import KnownLight
from voltcam_lab.light.scene import scene_of
from voltcam_lab.statistics.setting import PARTS, block_edges_us, checkerboard, setting_of
from voltcam_lab.statistics.strata import INTENSITIES, REST, SLOPES

from .streams import HEIGHT, PERIOD_US, PIXELS, WIDTH, brightening, still


@settings(deadline=None)
@given(
    begin_us=st.integers(-(10**6), 10**6), seconds=st.floats(0.1, 60), period_us=st.floats(2000, 100_000),
    late_us=st.integers(0, 5000),
)  # fmt: skip
def test_blocks_hold_whole_frame_periods(
    begin_us: int, seconds: float, period_us: float, late_us: int
) -> None:
    first_us, end_us = begin_us + late_us, begin_us + int(seconds * 1e6)
    edges = block_edges_us(first_us, begin_us, end_us, period_us)
    assert (edges[0], edges[-1]) == (begin_us, end_us)
    assert (np.diff(edges) > 0).all()
    periods = (edges[1:-1] - first_us) / period_us
    assert np.abs(periods - np.round(periods)).max(initial=0) * period_us <= 0.51
    assert np.diff(edges[1:-1]).min(initial=10**9) >= 4 * period_us - 1


@settings(deadline=None)
@given(st.integers(1, 60), st.integers(1, 60))
def test_tiles_are_squares_of_a_checkerboard(height: int, width: int) -> None:
    tiles, side = checkerboard(height, width), max(6, min(height, width) // 8)
    for y, x in ((0, 0), (height - 1, width - 1), (height // 2, width // 3)):
        assert tiles[y, x] == (y // side + x // side) % 2


def test_rises_falls_and_rest_add_up_to_the_light_s_own() -> None:
    """Half of the pixels go up and down again, the others rest."""
    t_us = np.arange(0, 2_000_001, PERIOD_US)
    swing = 1 - np.abs(t_us * 1e-6 - 1)  # up for a second, down for a second
    log = np.log(60) + np.where(np.arange(PIXELS) % 2, 1.0, 0.0) * swing[:, None]
    images = (np.exp(log) - 20).reshape(len(t_us), HEIGHT, WIDTH).astype(np.float32)
    setting = setting_of(scene_of(images, t_us, "linear"), t_us)
    moving = setting.pixels % 2 == 1
    up, down, rest_s = setting.path.sum(axis=0)
    unknown = 0.1  # at the ends light rests, for all that is known
    assert up[moving] == pytest.approx(1, abs=unknown)
    assert down[moving] == pytest.approx(1, abs=unknown)
    assert not up[~moving].any()
    assert rest_s[~moving] == pytest.approx(2)
    assert setting.bustle[:, -1].sum() == pytest.approx(2 * moving.sum(), rel=1e-3)
    assert setting.seconds.shape == (PARTS, INTENSITIES, SLOPES)
    assert setting.seconds[..., REST].sum() == pytest.approx(rest_s.sum())


def test_light_that_is_not_known_is_no_path_and_no_time() -> None:
    whole = brightening(2.0)
    gaps = np.ones((200, PIXELS), bool)
    gaps[50:150, : PIXELS // 2] = False  # half of the time, in half of the pixels
    setting = setting_of(whole.scene, whole.frame_t_us, known=KnownLight(gaps, whole.scene.taken_us, WIDTH))
    share = np.where(np.arange(PIXELS) < PIXELS // 2, 0.5, 1.0)
    assert setting.seconds.sum() == pytest.approx(2.0 * share.sum())
    assert setting.path.sum(axis=(0, 1)) == pytest.approx(whole.path.sum(axis=(0, 1)) * share, rel=0.02)
    assert setting.bustle[:, -1].sum() == pytest.approx(0.75 * whole.bustle[:, -1].sum(), rel=0.02)


def test_pixels_that_are_kept_have_their_places() -> None:
    keep = np.random.default_rng(1).random((HEIGHT, WIDTH)) < 0.3
    setting = still(0.5, keep=keep)
    assert setting.pixels.tolist() == np.flatnonzero(keep).tolist()
    assert (setting.place[setting.pixels] == np.arange(len(setting.pixels))).all()
    assert (setting.place[~keep.ravel()] == -1).all()
    assert setting.seconds.sum() == pytest.approx(0.5 * keep.sum())


def test_what_tells_nothing_is_refused() -> None:
    whole = brightening(0.2)
    with pytest.raises(ValueError, match="no pixel is kept: give a mask"):
        setting_of(whole.scene, whole.frame_t_us, np.zeros((HEIGHT, WIDTH), bool))
    with pytest.raises(ValueError, match="fewer than two frames"):
        setting_of(whole.scene, whole.frame_t_us[:1])
