"""Who is held against a recording: Voltcam by both laws, calibrated; what is published; the baselines."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from voltcam_client.formats import Recording
from voltcam_simulator import Parameters

from ..calibration.calibrate import CalibrationError, Reading, calibrate, scene_between
from ..calibration.paper_method import calibrate_as_paper
from ..calibration.refine.refine import Refined, refine
from ..distances import FrameLight, Region
from ..health import frame_mask
from ..light.scene import Scene
from ..models.model import MODELS, AnyParameters, Model, with_fitted_thresholds
from ..windows import Mask

SEED = 1
Contenders = dict[str, Callable[[], Model]]
Progress = Callable[[str], None]


def contenders(
    recording: Recording, fitting: Region, progress: Progress = lambda _: None
) -> tuple[Scene, Contenders, list[str]]:
    """(the light, makers of models by name, notes: what was found, what could not be fitted and why), fitted
    on `fitting` only.

    Calibrated: all parameters; by the exact law refined, and with it the light that all models are shown.
    Thresholds fitted: the published parameters, with the two thresholds that give as many events of each
    polarity as the recording has.
    """
    if recording.frames is None or recording.frame_t_us is None:
        raise ValueError("the recording has no frames: models have nothing to look at")
    scene = scene_between(recording.frames, recording.frame_t_us)
    masked = mask_of(recording, fitting)
    reading = Reading(recording.events, scene, fitting.pixels, masked)
    seen = fitting.of(recording.events)
    on = int(np.count_nonzero(seen["p"]))
    notes: list[str] = []

    def thresholds(model: str, parameters: AnyParameters | None = None) -> AnyParameters:
        return with_fitted_thresholds(model, scene, on, seen.size - on, parameters, SEED, fitting.of)

    published, ideal = Parameters.of("paper"), Parameters.of("ideal")
    start: AnyParameters
    try:
        progress("fitting the likelihood")
        start = calibrate(reading, report=progress).parameters
    except CalibrationError as error:
        notes.append(f"exact, calibrated: refined from fitted thresholds, since {_line(error)}")
        start = thresholds("exact", ideal)
    assert isinstance(start, Parameters)  # models that are not ours have others
    light = FrameLight(recording.frames, recording.frame_t_us)
    refined = refine(recording.events, scene, light, fitting, start, SEED, progress)
    scene = refined.scene
    notes.append(_told(refined))
    ways: dict[str, tuple[str, Callable[[], AnyParameters]]] = {
        "exact, calibrated": ("exact", lambda: refined.parameters),
        "exact, by likelihood alone": ("exact", lambda: start),
        "paper, calibrated": (
            "paper",
            lambda: calibrate_as_paper(recording.events, scene, fitting.pixels, masked).parameters,
        ),
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


def mask_of(recording: Recording, fitting: Region) -> Mask:
    """The times that fits leave out: all that is not for fitting, and what the camera's own frames disturb,
    of each row its own."""
    mask = frame_mask(recording)
    apart = replace(fitting, hidden=np.empty((0, 2), np.int64)).without(mask.windows)
    return replace(mask, windows=apart.outside())


def _told(refined: Refined) -> str:
    kept = ", ".join(refined.kept) or "none"
    return (
        f"exact, calibrated: the light between frames {refined.light}; mechanisms that helped pixels which "
        f"had no part in the choice: {kept}; their score went from {refined.before:.2f} to "
        f"{refined.after:.2f}"
    )


def _line(error: Exception) -> str:
    return " ".join(str(error).split())
