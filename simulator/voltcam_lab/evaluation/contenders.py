"""Who is held against a recording: Voltcam by both laws, calibrated; what is published; the baselines."""

from collections.abc import Callable
from functools import partial

import numpy as np

from voltcam_simulator import Parameters

from ..calibration.calibrate import CalibrationError, Reading, calibrate
from ..calibration.lateness import clocks_apart_us
from ..calibration.paper_method import calibrate_as_paper
from ..calibration.refine.refinement import Refined, Refinement
from ..distances import FrameLight, Region
from ..health import Inspection
from ..light.between_frames import scene_between
from ..light.scene import Scene
from ..models.model import MODELS, AnyParameters, Model, with_fitted_thresholds
from ..windows import Mask

SEED = 1
Contenders = dict[str, Callable[[], Model]]
Progress = Callable[[str], None]


def contenders(
    inspection: Inspection, fitting: Region, progress: Progress = lambda _: None
) -> tuple[Scene, Contenders, list[str]]:
    """(the light, makers of models by name, notes: what was found, what could not be fitted and why), fitted
    on `fitting` only.

    Calibrated: all parameters; by the exact law refined, and with it the light that all models are shown.
    Thresholds fitted: the published parameters, with the two thresholds that give as many events of each
    polarity as the recording has.
    """
    recording = inspection.footage
    scene = scene_between(recording.frames, recording.frame_t_us)
    masked = mask_for_fit(inspection.mask, fitting)
    reading = Reading(recording.events, scene, fitting.pixels, masked)
    seen = fitting.of(recording.events)
    on = int(np.count_nonzero(seen["p"]))
    notes: list[str] = []

    def thresholds(model: str, parameters: AnyParameters | None = None) -> AnyParameters:
        return with_fitted_thresholds(model, scene, on, seen.size - on, parameters, SEED, fitting.of)

    def as_paper() -> AnyParameters:
        fitted = calibrate_as_paper(recording.events, scene, fitting.pixels, masked)
        notes.extend(f"paper, calibrated: {note}" for note in fitted.notes)
        return fitted.parameters

    published, ideal = Parameters.of("paper"), Parameters.of("ideal")
    start: AnyParameters
    try:
        progress("fitting the likelihood")
        apart_us = clocks_apart_us(inspection.lag)
        start = calibrate(reading, report=progress, clocks_apart_us=apart_us).parameters
    except CalibrationError as error:
        notes.append(f"exact, calibrated: refined from fitted thresholds, since {_line(error)}")
        start = thresholds("exact", ideal)
    assert isinstance(start, Parameters)  # models that are not ours have others
    light = FrameLight(recording.frames, recording.frame_t_us)
    refined = Refinement(recording.events, scene, light, fitting, SEED, progress).refined(start)
    scene = refined.scene
    notes.append(_told(refined))
    ways: dict[str, tuple[str, Callable[[], AnyParameters]]] = {
        "exact, calibrated": ("exact", lambda: refined.parameters),
        "exact, by likelihood alone": ("exact", lambda: start),
        "paper, calibrated": ("paper", as_paper),
        "paper, thresholds fitted": ("paper", lambda: thresholds("paper", published)),
        "esim, thresholds fitted": ("esim", lambda: thresholds("esim")),
        "v2e, thresholds fitted": ("v2e", lambda: thresholds("v2e")),
        "paper, as published": ("paper", lambda: published),
        "no noise, thresholds fitted": ("exact", lambda: thresholds("exact", ideal)),
    }
    makers: Contenders = {}
    for name, (model, parameters) in ways.items():
        progress(f"fitting {name}")
        try:
            found = parameters()
        except ValueError as error:
            notes.append(f"{name}: could not be fitted: {_line(error)}")
            continue
        makers[name] = partial(MODELS[model], scene.width, scene.height, found, SEED)
    return scene, makers, notes


def mask_for_fit(mask: Mask, fitting: Region) -> Mask:
    """The times that fits leave out: all that is not for fitting, and what the camera's own frames disturb,
    of each row its own."""
    return mask.only(fitting.times)


def _told(refined: Refined) -> str:
    kept = ", ".join(refined.kept) or "none"
    return (
        f"exact, calibrated: the light between frames {refined.light}. Mechanisms that helped pixels which "
        f"had no part in the choice: {kept}. Their score went from {refined.before:.2f} to "
        f"{refined.after:.2f}"
    )


def _line(error: Exception) -> str:
    return " ".join(str(error).split())
