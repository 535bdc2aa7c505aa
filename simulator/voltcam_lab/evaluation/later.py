"""First part against later part: a camera calibrated as a user would, judged on what came afterwards.

Nothing is shared but the camera itself. All pixels are judged; once with the windows about exposures cut out,
once with all events, as a user of the emulator sees them.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from voltcam_simulator import Parameters
from voltcam_simulator.effect import Events

from ..calibration.camera_from import camera_from
from ..distances import Region
from ..health import Inspection, inspect
from ..light.scene import Scene, scene_of
from ..models.model import MODELS, simulate, with_fitted_thresholds
from ..recordings import Footage
from .contenders import SEED
from .evaluate import Evaluation, judged, yardstick_of

FIRST = 0.6  # of the time...
SHORTEST_US, MOST = 1_600_000, 0.8  # ...and what a calibration needs, of a recording that is hardly longer
CUT = "first part against later part, windows about exposures cut out"
ALL = "first part against later part, all events"
Progress = Callable[[str], None]


def later_part(
    inspection: Inspection, name: str, progress: Progress = lambda _: None
) -> dict[str, Evaluation]:
    """By protocol: the calibrated camera, and noise-free and published pixels with thresholds fitted to the
    first part's totals. Raises ValueError as `yardstick_of` and `camera_from` do."""
    footage, whole = inspection.footage, yardstick_of(inspection, name)
    change_us, t_us = change_of(footage), footage.frame_t_us
    progress("calibrating on the first part")
    first = first_part(footage, change_us)
    camera = camera_from(inspect(first), report=progress).camera
    progress("light between frames")
    scene = scene_of(footage.frames, t_us, "auto")
    simulated = _simulated(footage, scene, first, camera.parameters, progress)
    later = np.array([[change_us, int(t_us[-1])]], np.int64)
    shown = Region.whole(footage.width, footage.height, int(t_us[0]), int(t_us[-1])).on(~inspection.hot)
    regions = {CUT: whole.region.during(later), ALL: shown.during(later)}
    return {title: judged(inspection, simulated, region, name, progress) for title, region in regions.items()}


def change_of(footage: Footage) -> int:
    """When the first part ends and the later one begins [us]."""
    begin_us, end_us = int(footage.frame_t_us[0]), int(footage.frame_t_us[-1])
    span_us = end_us - begin_us
    return begin_us + int(max(FIRST * span_us, min(SHORTEST_US, MOST * span_us)))


def first_part(footage: Footage, end_us: int) -> Footage:
    """What a recording has up to a time."""
    kept = footage.frame_t_us <= end_us
    return replace(
        footage,
        events=footage.events[footage.events["t"] <= footage.frame_t_us[kept][-1]],
        frames=footage.frames[kept],
        frame_t_us=footage.frame_t_us[kept],
        exposure_us=None if footage.exposure_us is None else footage.exposure_us[kept],
    )


def _simulated(
    footage: Footage, scene: Scene, first: Footage, calibrated: Parameters, progress: Progress
) -> dict[str, Events]:
    begin_us, end_us = int(first.frame_t_us[0]), int(first.frame_t_us[-1])

    def counted(events: Events) -> Events:
        inside: Events = events[(events["t"] >= begin_us) & (events["t"] <= end_us)]
        return inside

    real = counted(first.events)
    on = int(np.count_nonzero(real["p"]))
    begin = replace(scene, images=scene.images[scene.t_us <= end_us], t_us=scene.t_us[scene.t_us <= end_us])
    found = {}
    for name, model, parameters in (
        ("exact, calibrated", "exact", calibrated),
        ("no noise, thresholds fitted", "exact", Parameters.of("ideal")),
        ("paper, thresholds fitted", "paper", Parameters.of("paper")),
    ):
        progress(name)
        fitted = parameters
        if parameters is not calibrated:
            wanted = on, real.size - on
            fitted = with_fitted_thresholds(model, begin, *wanted, parameters, SEED, counted)  # type: ignore[assignment]
        found[name] = simulate(MODELS[model](footage.width, footage.height, fitted, SEED), scene)
    return found
