"""What a recording can determine."""

import numpy as np
import pytest
from tests.lab.health.made import HEIGHT, LEAK_HZ, PERIOD_US, WIDTH, light, recording_of, some_events, well

from voltcam_lab.health import inspect


def test_an_image_held_still_is_of_limited_use() -> None:
    rng = np.random.default_rng(4)
    frames = (light(0) + rng.normal(0, 1, (160, HEIGHT, WIDTH))).round().astype(np.uint8)
    columns = [rng.integers(0, n, 6000) for n in (4_000_000, WIDTH, HEIGHT)]
    health = inspect(recording_of(some_events(*columns, True), frames, np.arange(160) * PERIOD_US)).health
    assert health.usable
    assert health["light"].severity == "limits"
    answers = {item.parameters[0]: item.answer for item in health.determinations}
    assert (answers["k1"], answers["k4_per_us"]) == ("no", "yes")


def test_what_it_can_determine() -> None:
    items = {item.parameters[0]: item for item in well().health.determinations}
    assert {name: item.answer for name, item in items.items()} == {
        "k1": "in part",  # 40 to 130 DN move
        "theta_on": "yes",
        "k4_per_us": "yes",
        "k3": "yes",
        "period_us": "no",
        "threshold_mismatch": "yes",
        "temperature_c": "no",
    }
    rest_s = np.asarray(well().health["light at rest"].numbers["rest_pixel_s"]).sum()
    assert items["k4_per_us"].numbers["on_at_rest"] == pytest.approx(LEAK_HZ * rest_s, rel=0.1)
