"""First part against later part: what calibration sees, and what is judged."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from voltcam_lab.evaluation import later
from voltcam_lab.health import Inspection
from voltcam_lab.recordings import Footage

from .conftest import TRUTH


@pytest.fixture
def seen(monkeypatch: pytest.MonkeyPatch) -> list[Footage]:
    given: list[Footage] = []

    def calibrated(inspection: Inspection, **_: object) -> object:
        given.append(inspection.footage)
        return SimpleNamespace(camera=SimpleNamespace(parameters=TRUTH))

    monkeypatch.setattr(later, "camera_from", calibrated)
    return given


def test_the_camera_is_of_the_first_part_and_judged_on_the_rest(
    inspection: Inspection, seen: list[Footage]
) -> None:
    found = later.later_part(inspection, "waves")
    (first,) = seen
    t_us = inspection.footage.frame_t_us
    change_us = int(t_us[0] + 0.8 * (t_us[-1] - t_us[0]))  # of 1.6 s, which is hardly enough to calibrate
    assert first.events["t"].max() <= first.frame_t_us[-1] <= change_us
    assert set(found) == {later.CUT, later.ALL}
    for evaluation in found.values():
        assert evaluation.yardstick.region.times.tolist() == [[change_us, int(t_us[-1])]]
        assert set(evaluation.rows) == {
            "exact, calibrated", "no noise, thresholds fitted", "paper, thresholds fitted"
        }  # fmt: skip
        distances = evaluation.rows["exact, calibrated"]
        assert distances["W1"] < 0.05  # it is the camera itself
        assert np.isfinite(distances["nats"])
    assert len(found[later.ALL].yardstick.region.hidden) == 0


def test_exposures_go_with_their_frames(inspection: Inspection) -> None:
    footage = inspection.footage
    exposures = np.column_stack([footage.frame_t_us - 100, footage.frame_t_us + 100])
    part = later.first_part(replace(footage, exposure_us=exposures), int(footage.frame_t_us[7]))
    assert len(part.frames) == len(part.frame_t_us) == 8
    assert part.exposure_us is not None
    assert part.exposure_us.tolist() == exposures[:8].tolist()
