"""A pair put to `calibrate`, and how far the camera found is from the second recording."""

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from pydantic import BaseModel, ConfigDict

from voltcam_lab.calibration.camera_from import camera_from
from voltcam_lab.distances import FrameLight, Region
from voltcam_lab.distances import counts as count
from voltcam_lab.distances import inter_event_intervals as intervals
from voltcam_lab.health import Inspection, inspect
from voltcam_lab.health.lag import find_lag
from voltcam_lab.light.scene import scene_of
from voltcam_lab.models.model import MODELS, simulate
from voltcam_lab.recordings import Footage
from voltcam_simulator import Parameters
from voltcam_simulator.effect import Events

from .hidden_camera import true_file
from .pairs import Pair, footage

MEASURED = ("W1", "TVs", "pair")
SEED = 1


class Row(BaseModel):
    """Distances from the second recording, and the lag behind its events [us]."""

    model_config = ConfigDict(frozen=True)

    W1: float
    TVs: float
    pair: float
    lag_us: float
    on: float  # events, of the real ones
    off: float


class Outcome(BaseModel):
    """Of a pair. true, calibrated, likeliest: simulated from the frames of the second recording, with the
    hidden values, with what was found, and with that less what refinement moved. again: the hidden camera's
    own second run of that scene. Delays are those of the two files [us]."""

    model_config = ConfigDict(frozen=True)

    seed: int
    code: str = ""
    again: Row | None = None
    true: Row | None = None
    calibrated: Row | None = None
    likeliest: Row | None = None
    true_delay_us: float = 0.0
    delay_us: float = 0.0
    parameters: dict[str, dict[str, float | int | bool]] = {}  # of the file, as it was found
    wall_s: float = 0.0  # of the calibration
    error: str = ""

    def ratio(self, name: str, likeliest: bool = False) -> float:
        """Of a distance that calibration reaches to that which the true values reach."""
        row = self.likeliest if likeliest else self.calibrated
        if self.true is None or row is None:
            return float("inf")
        return float(getattr(row, name) / getattr(self.true, name))

    @property
    def late_us(self) -> float:
        """How much later the calibrated events are than the recorded ones."""
        return self.calibrated.lag_us if self.calibrated else float("inf")


Calibrate = Callable[[Inspection], tuple[Parameters, Parameters]]


def calibrated(inspection: Inspection, refining: bool = True) -> tuple[Parameters, Parameters]:
    """What `voltcam calibrate` finds, and the same with what refinement moved put back, but for the delay,
    which is found after it. refining: without `--no-refine`."""
    found = camera_from(inspection, refining=refining)
    back: dict[str, dict[str, float]] = {}
    for name, likeliest, _ in found.moved:
        effect, parameter = name.split(".")
        if name != "latency.delay_us":
            back.setdefault(effect, {})[parameter] = likeliest
    return found.camera.parameters, found.camera.parameters.changed(back)


def judged(pair: Pair, calibrate: Calibrate = calibrated, code: str = "") -> Outcome:
    """Calibrate on the first recording, simulate the second, and measure."""
    begun = time.perf_counter()
    found, likeliest = calibrate(inspect(footage(pair.recording(0))))
    wall_s = time.perf_counter() - begun
    second = inspect(footage(pair.recording(1)))
    true = true_file(pair.camera, pair.height)
    scene = scene_of(second.footage.frames, second.footage.frame_t_us, "auto")

    def simulated(parameters: Parameters) -> Events:
        return simulate(MODELS["exact"](pair.width, pair.height, parameters, SEED), scene)

    rows = {"again": row(second, pair.recording(1, run=1).events)}
    for name, parameters in (("true", true), ("calibrated", found), ("likeliest", likeliest)):
        rows[name] = row(second, simulated(parameters))
    return Outcome(
        seed=pair.seed, code=code, **rows, true_delay_us=true.latency.delay_us,
        delay_us=found.latency.delay_us, parameters=found.model_dump(exclude_defaults=True), wall_s=wall_s,
    )  # fmt: skip


def row(second: Inspection, events: Events) -> Row:
    """Of other events of the second recording's scene. All events count but those of hot pixels."""
    seen: Footage = second.footage
    t_us = seen.frame_t_us
    region = Region.whole(seen.width, seen.height, int(t_us[0]), int(t_us[-1])).on(~second.hot)
    light = FrameLight(seen.frames, t_us)
    same = [intervals.same_polarity(one, region) for one in (seen.events, events)]
    either = [intervals.any_polarity(one, region) for one in (seen.events, events)]
    strata = intervals.IntervalStrata.of(same[0], light)
    real_on, real_off = count.rates(seen.events, region)
    on, off = count.rates(events, region)
    late = find_lag(inspect(replace(seen, events=events)).subject).lag_us - second.lag.lag_us
    return Row(
        W1=intervals.wasserstein(*same), TVs=intervals.stratified_variation(*same, strata),
        pair=intervals.wasserstein(*either), lag_us=float(np.round(late, 1)), on=on / real_on,
        off=off / real_off,
    )  # fmt: skip
