"""Who is held against a recording: what fits see, and what is said of them."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from voltcam_lab.calibration.calibrate import CalibrationError
from voltcam_lab.calibration.refine.refinement import Refined, Refinement
from voltcam_lab.distances import held_out
from voltcam_lab.evaluation import contenders
from voltcam_lab.evaluation.evaluate import yardstick_of
from voltcam_lab.health import Inspection
from voltcam_simulator import Parameters


def test_fits_see_nothing_of_what_is_judged(inspection: Inspection, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: dict[str, Any] = {}

    def reading(*given: object) -> object:
        seen["reading"] = given
        raise ValueError("enough")

    monkeypatch.setattr(contenders, "Reading", reading)
    fitting, judging = held_out(yardstick_of(inspection).region)
    with pytest.raises(ValueError, match="enough"):
        contenders.contenders(inspection, fitting)
    *_, keep, masked = seen["reading"]
    assert not (keep & judging.pixels).any()
    for begin, end in judging.times.tolist():
        assert any(first <= begin and end <= last for first, last in masked.windows.tolist())


class Fits:
    """In place of all fits: what they were given, and what they are to find."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.thresholds: list[tuple[str, int, int]] = []
        self.start: list[Parameters] = []
        monkeypatch.setattr(contenders, "calibrate", self.calibrate)
        monkeypatch.setattr(Refinement, "refined", lambda own, start: self.refined(own, start))
        monkeypatch.setattr(contenders, "calibrate_as_paper", self.as_paper)
        monkeypatch.setattr(contenders, "with_fitted_thresholds", self.fitted)

    def calibrate(self, *_: object, **__: object) -> object:
        raise CalibrationError("too few\n events")

    def as_paper(self, *_: object) -> object:
        raise ValueError("no bin\n has enough")

    def refined(self, refinement: Refinement, start: Parameters) -> Refined:
        self.start.append(start)
        scene = replace(refinement.scene, how="linear")
        return Refined(start, scene, "as it was", ("hot",), (), 3.0, 1.5, True)

    def fitted(self, model: str, scene: object, on: int, off: int, parameters: Any = None, *_: object) -> Any:
        self.thresholds.append((model, on, off))
        return parameters


def test_what_cannot_be_fitted_is_said_and_left_out(
    inspection: Inspection, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without a likelihood the refinement begins at fitted thresholds."""
    fits, (fitting, _) = Fits(monkeypatch), held_out(yardstick_of(inspection).region)
    said: list[str] = []
    scene, makers, notes = contenders.contenders(inspection, fitting, said.append)
    assert fits.start == [Parameters.of("ideal")]
    assert scene.how == "linear"  # the refined one, for all
    assert notes == [
        "exact, calibrated: refined from fitted thresholds, since too few events",
        "exact, calibrated: the light between frames as it was. Mechanisms that helped pixels which had no "
        "part in the choice: hot. Their score went from 3.00 to 1.50",
        "paper, calibrated: could not be fitted: no bin has enough",
    ]
    assert "paper, calibrated" not in makers
    assert {step.removeprefix("fitting ") for step in said} == {
        *makers,
        "the likelihood",
        "paper, calibrated",
    }


def test_thresholds_are_fitted_to_what_is_not_judged(
    inspection: Inspection, monkeypatch: pytest.MonkeyPatch
) -> None:
    fits, (fitting, _) = Fits(monkeypatch), held_out(yardstick_of(inspection).region)
    contenders.contenders(inspection, fitting)
    seen = fitting.of(inspection.footage.events)
    on = int(np.count_nonzero(seen["p"]))
    assert {(a, b) for _, a, b in fits.thresholds} == {(on, seen.size - on)}
    assert [model for model, *_ in fits.thresholds] == ["exact", "paper", "esim", "v2e", "exact"]


def test_makers_give_models_of_the_recording_s_size(
    inspection: Inspection, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, (fitting, _) = Fits(monkeypatch), held_out(yardstick_of(inspection).region)
    scene, makers, _ = contenders.contenders(inspection, fitting)
    for name in ("exact, calibrated", "esim, thresholds fitted", "paper, as published"):
        assert makers[name]().advance(scene.images[0], 0).size == 0
        with pytest.raises(ValueError, match=r"\(3, 3\)"):
            makers[name]().advance(np.zeros((3, 3)), 0)
