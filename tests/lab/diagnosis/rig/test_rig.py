"""Runs of the model on a recording's scene."""

import numpy as np
import pytest

from voltcam_lab.diagnosis.catalogue.entries import acts_across_columns
from voltcam_lab.diagnosis.rig.rig import Rig
from voltcam_lab.light.scene import scene_of
from voltcam_lab.statistics import setting_of
from voltcam_simulator import Parameters

PAPER = Parameters.of("paper")


@pytest.fixture(scope="module")
def rig() -> Rig:
    t_us = np.arange(0, 1_000_001, 10_000)
    phase = t_us[:, None, None] * 4e-6 + np.arange(16) * 0.15 + np.arange(12)[:, None] * 0.1
    frames = (100 + 80 * np.sin(2 * np.pi * phase)).astype(np.float32)
    frames[40:60] = frames[40]
    return Rig(setting_of(scene_of(frames, t_us, "cubic"), t_us, parameters=PAPER))


@pytest.mark.parametrize(
    "effects",
    [
        {},
        {"aps_coupling": {"readout_kick": 0.2, "reset_kick": -0.1}},
        {"residual_drift": {"per_us": 1e-6, "power": 1.0, "down": 0.9}},
        {"crosstalk": {"coupling": 0.1}},
    ],
    ids=["paper", "row scan", "drift down the rows", "crosstalk"],
)
def test_sensors_side_by_side_see_what_single_ones_do(rig: Rig, effects: dict[str, dict[str, float]]) -> None:
    """Means of 24 runs each differ as those of other noise do: the mean square of 4 n deviations is off 1 by
    less than 0.3 in all but one of a million."""
    parameters = PAPER.changed(effects)
    assert not acts_across_columns(parameters)
    twins = rig.runs([parameters], range(1000, 1024))[0]
    apart = rig.runs([parameters], range(2000, 2024), apart=True)[0]
    sd = np.std(twins, axis=0, ddof=1)
    known = sd > 0.3  # of counts that are mostly 0 the spread is not known well
    z = (apart.mean(axis=0) - twins.mean(axis=0))[known] / sd[known] / np.sqrt(2 / 24)
    assert (z**2).mean() == pytest.approx(1, abs=0.3)


def test_the_same_seeds_give_the_same_noise(rig: Rig) -> None:
    first, again = (rig.run(PAPER, [4, 5]) for _ in range(2))
    np.testing.assert_array_equal(first, again)
    assert (first[0] != first[1]).any()
    unchanged, changed = rig.changes(
        PAPER, [PAPER, PAPER.changed({"vignetting": {"corner_loss": 0.5}})], [4, 5]
    )
    assert not unchanged.any()
    assert changed.any()


def test_what_was_run_is_remembered(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    """Fits begin where others have been: the same runs again are the same numbers, and not simulated."""
    again, simulated, observe = Rig(rig.setting), [], rig.observe
    monkeypatch.setattr(Rig, "observe", lambda self, events: simulated.append(events) or observe(events))
    many = [PAPER, PAPER.changed({"photon_noise": {"k3": 1e-3}})]
    first, second = again.runs(many, range(4)), again.runs(many[::-1], range(4))[::-1]
    assert len(simulated) == 2 * 4
    for one, other, parameters in zip(first, second, many, strict=True):
        np.testing.assert_array_equal(one, other)
        np.testing.assert_array_equal(one, again.run(parameters, range(4)))


def test_images_that_stand_still_are_left_out(rig: Rig) -> None:
    shown = rig.lights[1]
    assert {400_000, 590_000} <= set(shown)
    assert not {t for t in shown if 420_000 <= t <= 580_000}
