"""Group A: numbers of events by polarity, brightness and change of brightness."""

import numpy as np
import pytest

from voltcam_lab.light.scene import scene_of
from voltcam_lab.statistics import Setting, setting_of

from .streams import HEIGHT, WIDTH, brightening, seen, still, stream

SECONDS = 8.0


@pytest.fixture(scope="module")
def rest() -> Setting:
    return still(SECONDS)


@pytest.fixture(scope="module")
def rise() -> Setting:
    return brightening(2.0)


def test_rates_count_by_polarity_and_state(rest: Setting, rise: Setting) -> None:
    events = np.concatenate([stream([600_000] * 3, [0, 1, 2]), stream([700_000] * 2, [3, 4], False)])
    assert seen(rest, events, "A", "events", "ON", "rest").sum() == 3
    assert seen(rest, events, "A", "events", "OFF", "rest").sum() == 2
    assert seen(rise, events, "A", "events", "rest").sum() == 0
    assert seen(rise, events, "A", "events", "ON").sum() == 3


def test_intensity_goes_with_the_light(rise: Setting) -> None:
    early, late = stream([1, 50_000], [7, 7]), stream([1_950_000], [7])  # the first is not settled
    assert seen(rise, early, "A", "events", "darkest").sum() == 1
    assert seen(rise, late, "A", "events", "brightest").sum() == 1


def test_a_change_has_its_direction_and_its_speed() -> None:
    """A light that goes slowly up, fast up, slowly down, fast down, and rests: one event in each."""
    knots_s = np.array([0, 1, 1.2, 2.2, 2.4, 4])
    log = np.array([0.0, 0.5, 1.5, 1.0, 0.0, 0.0])
    t_us = np.arange(0, 4_000_001, 10_000)
    grey = 60 * np.exp(np.interp(t_us * 1e-6, knots_s, log)) - 20
    images = np.broadcast_to(grey[:, None, None], (len(t_us), HEIGHT, WIDTH)).astype(np.float32)
    setting = setting_of(scene_of(images, t_us, "linear"), t_us)
    slopes = {
        500_000: "rising",
        1_100_000: "rising fast",
        1_700_000: "falling",
        2_300_000: "falling fast",
        3_500_000: "rest",
    }
    for t, name in slopes.items():
        assert seen(setting, stream([t], [3]), "A", "events", name).sum() == 1, name
