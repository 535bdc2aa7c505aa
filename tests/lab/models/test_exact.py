"""Where the numbers of the exact law stand, and which of them are in units of the threshold."""

import numpy as np

from voltcam_lab.light.scene import Scene, scene_of
from voltcam_lab.models.exact import IN_THRESHOLDS, K1_TO_K6, SPREADS
from voltcam_lab.models.model import MODELS, simulate
from voltcam_simulator import Parameters

START = Parameters.of("paper")


def scene() -> Scene:
    """A plaid that moves over 12 x 9 pixels, half a second."""
    y, x = np.indices((9, 12))
    t_us = np.arange(0, 500_001, 10_000)
    images = [110 + 80 * np.sin((x + y - t / 20_000) / 2) for t in t_us]
    return scene_of(np.array(images, np.float32), t_us, "linear")


def test_each_place_is_a_number_of_a_camera_file() -> None:
    for effect, parameter in (K1_TO_K6 | SPREADS).values():
        changed = START.changed({effect: {parameter: 0.125}})
        assert getattr(getattr(changed, effect), parameter) == 0.125
        assert changed != START


def test_with_another_unit_of_the_threshold_the_same_events_come_out() -> None:
    """Twice all that is in thresholds, and the thresholds: to the bit, as a factor of 2 rounds nothing."""
    twice: dict[str, dict[str, float]] = {
        "comparator": {"theta_on": 2 * START.comparator.theta_on, "theta_off": 2 * START.comparator.theta_off}
    }
    for name in IN_THRESHOLDS:
        effect, parameter = K1_TO_K6[name]
        twice.setdefault(effect, {})[parameter] = 2 * getattr(getattr(START, effect), parameter)
    one, other = (simulate(MODELS["exact"](12, 9, p, 3), scene()) for p in (START, START.changed(twice)))
    assert len(one) > 200
    assert one.tolist() == other.tolist()
    del twice["contrast_response"]
    assert simulate(MODELS["exact"](12, 9, START.changed(twice), 3), scene()).tolist() != one.tolist()
