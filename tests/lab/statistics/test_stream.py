"""Where and when in the setting each event was, against looking it up one by one."""

import numpy as np
import pytest

from voltcam_lab.light.known import KnownLight
from voltcam_lab.statistics.setting import setting_of
from voltcam_lab.statistics.strata import SLOPES
from voltcam_lab.statistics.stream import NONE, stream_of

from .streams import HEIGHT, PERIOD_US, PIXELS, WIDTH, brightening, poisson


def test_each_event_is_in_its_step_block_and_tile_with_its_light_and_its_former() -> None:
    """Steps and blocks end with the time that they end at. Every third pixel is kept."""
    whole = brightening(2.0)
    keep = (np.arange(PIXELS) % 3 == 0).reshape(HEIGHT, WIDTH)
    setting = setting_of(whole.scene, whole.frame_t_us, keep)
    rng = np.random.default_rng(1)
    events = poisson(rng, 2.0, 2.0)
    events["p"] = rng.random(len(events)) < 0.5
    events["t"] = events["t"] // 5000 * 5000  # some at the ends of steps, at 0, and at the same time
    found = stream_of(setting, events)
    edges, scene_us = setting.block_edges_us, setting.scene.t_us
    kept = [
        (t, y * WIDTH + x, on)
        for t, x, y, on in events.tolist()
        if 0 < t <= 2_000_000 and (y * WIDTH + x) % 3 == 0
    ]
    kept.sort()
    assert len(found.t_us) == len(kept)
    last: dict[int, int] = {}
    for i, (t, pixel, on) in enumerate(kept):
        assert (found.t_us[i], found.pixel[i], found.on[i]) == (t, pixel, on)
        step = next(k for k in range(len(scene_us) - 1) if scene_us[k] < t <= scene_us[k + 1])
        block = next(k for k in range(len(edges) - 1) if edges[k] < t <= edges[k + 1])
        place = setting.pixels.tolist().index(pixel)
        assert found.quarter[i] == block % 4
        assert found.part[i] == 2 * (block % 2) + setting.tiles.ravel()[pixel]
        assert SLOPES * found.intensity[i] + found.slope[i] == setting.strata.index[step, place]
        assert found.former[i] == last.get(pixel, -1)
        assert found.interval_us[i] == (t - kept[last[pixel]][0] if pixel in last else NONE)
        last[pixel] = i
    assert found.log == pytest.approx(np.log(25) + 1.15e-6 * found.t_us, abs=1e-3)


def test_an_interval_through_light_that_is_not_known_is_none() -> None:
    """Such light holds no events either. Brute force, pixel by pixel."""
    whole = brightening(2.0)
    gaps = np.random.default_rng(3).random((200, PIXELS)) < 0.9
    known = KnownLight(gaps, whole.scene.taken_us, WIDTH)
    setting = setting_of(whole.scene, whole.frame_t_us, known=known)
    events = poisson(np.random.default_rng(4), 30.0, 2.0)
    found = stream_of(setting, events)
    gap = found.t_us // PERIOD_US
    assert gaps[gap, found.pixel].all()
    kept = gaps[events["t"] // PERIOD_US, events["y"].astype(int) * WIDTH + events["x"]]
    assert len(found.t_us) == kept.sum() < len(events)
    last: dict[int, int] = {}
    cut = 0
    for i, pixel in enumerate(found.pixel.tolist()):
        before = last.get(pixel, -1)
        through = before >= 0 and gaps[gap[before] : gap[i] + 1, pixel].all()
        cut += before >= 0 and not through
        assert found.former[i] == (before if through else -1)
        assert found.interval_us[i] == (found.t_us[i] - found.t_us[before] if through else NONE)
        last[pixel] = i
    assert cut > 1000


def test_events_that_light_which_is_not_known_may_have_made_are_not_settled() -> None:
    """The first of its pixel within half a second of such light, or of the beginning. Brute force."""
    whole = brightening(2.0)
    gaps = np.random.default_rng(5).random((200, PIXELS)) < 0.99
    setting = setting_of(whole.scene, whole.frame_t_us, known=KnownLight(gaps, whole.scene.taken_us, WIDTH))
    found = stream_of(setting, poisson(np.random.default_rng(6), 2.0, 2.0))
    settled = []
    for t, pixel, former in zip(found.t_us, found.pixel, found.former, strict=True):
        unknown = np.flatnonzero(~gaps[: t // PERIOD_US, pixel])
        since_us = (unknown[-1] + 1) * PERIOD_US if unknown.size else 0
        settled.append(former >= 0 or t - since_us >= 500_000)
    assert (found.unsettled == 0).tolist() == settled
    assert 100 < sum(settled) < len(settled) - 100
    for name in ("t_us", "pixel", "on", "part", "quarter", "log", "interval_us"):
        np.testing.assert_array_equal(getattr(found.settled, name), getattr(found, name)[settled])
