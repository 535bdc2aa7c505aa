"""Group H: how long after a change of brightness its events come."""

import numpy as np
import pytest

from voltcam_lab.light.scene import scene_of
from voltcam_lab.statistics import Setting, setting_of
from voltcam_lab.statistics.lag_response import EDGES_US

from .streams import HEIGHT, PERIOD_US, WIDTH, brightening, poisson, seen, settled, stream


@pytest.fixture(scope="module")
def rise() -> Setting:
    return brightening(2.0)


def test_lag_response_is_slope_times_span(rise: Setting) -> None:
    events = poisson(np.random.default_rng(9), 20.0, 2.0)
    events = settled(events[events["t"] < 1_900_000])
    for lag, span_s in (("-2 to 0 ms", 2e-3), ("0.2 to 0.5 ms", 3e-4), ("12 to 40 ms", 28e-3)):
        total = seen(rise, events, "H", "change before events", lag).sum()
        assert total == pytest.approx(1.15 * span_s * len(events), rel=0.02)


def test_changes_are_the_scene_s_own_with_the_sign_of_the_event() -> None:
    """A wave: ln(L + 20) read from it at both ends of each lag; beyond its ends the scene stands still. The
    first event of the pixel is not settled, and does not count."""
    t_us = np.arange(0, 600_001, PERIOD_US)
    log = np.log(120 + 60 * np.sin(t_us / 50_000))
    images = np.broadcast_to(np.exp(log)[:, None, None] - 20, (len(t_us), HEIGHT, WIDTH)).astype(np.float32)
    setting = setting_of(scene_of(images, t_us, "linear"), t_us)
    at = np.array([3000, 77_700, 301_234, 599_500])
    on = np.array([True, False, True, False])
    wanted = np.zeros(len(EDGES_US) - 1)
    for t, sign in zip(at, np.where(on, 1, -1), strict=True):
        levels = np.interp(t - np.array(EDGES_US), t_us, log)
        wanted += sign * -np.diff(levels)
    events = stream(np.append(1, at), 7, np.append(True, on))
    found = seen(setting, events, "H", "change before events").reshape(-1, len(wanted))
    assert found.sum(axis=0) == pytest.approx(wanted, abs=1e-5)
