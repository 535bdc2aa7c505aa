"""Who is held against a recording: Voltcam by both laws, calibrated; what is published; the baselines."""

from collections.abc import Callable
from functools import partial

import numpy as np

from voltcam_client.formats import Recording
from voltcam_simulator import Parameters

from .calibrate import Reading, calibrate, scene_between
from .distances import Region
from .models import MODELS, AnyParameters, Model, fitted
from .paper_method import calibrate_as_paper
from .scene import Scene

SEED = 1
Contenders = dict[str, Callable[[], Model]]


def contenders(
    recording: Recording, fitting: Region, progress: Callable[[str], None] = lambda _: None
) -> tuple[Scene, Contenders, list[str]]:
    """(the light, makers of models by name, what could not be fitted and why), fitted on `fitting` only.

    Calibrated: all parameters. Thresholds fitted: the published parameters, with the two thresholds that give
    as many events of each polarity as the recording has.
    """
    if recording.frames is None or recording.frame_t_us is None:
        raise ValueError("the recording has no frames: models have nothing to look at")
    masked = fitting.outside()
    scene = scene_between(recording.frames, recording.frame_t_us)
    reading = Reading(recording.events, scene, fitting.pixels, masked)
    seen = fitting.of(recording.events)
    on = int(np.count_nonzero(seen["p"]))

    def thresholds(model: str, parameters: AnyParameters | None = None) -> AnyParameters:
        return fitted(model, scene, on, seen.size - on, parameters, SEED, fitting.of)

    published, ideal = Parameters.of("paper"), Parameters.of("ideal")
    ways: dict[str, tuple[str, Callable[[], AnyParameters]]] = {
        "exact, calibrated": ("exact", lambda: calibrate(reading, report=progress).parameters),
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
    missing = []
    for name, (model, parameters) in ways.items():
        progress(f"fitting {name}")
        try:
            found = parameters()
        except ValueError as error:
            missing.append(f"{name}: {' '.join(str(error).split())}")
            continue
        makers[name] = partial(MODELS[model], scene.width, scene.height, found, SEED)
    return scene, makers, missing
