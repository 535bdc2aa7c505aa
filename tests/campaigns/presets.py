"""How much presets give on the later part of the recordings that they were calibrated on: `make presets`.

The folder VOLTCAM_DATA, or ../shared/data, has `slider_depth` and `davis346_street`. Light between frames is
made as `--upsample auto` does. The calibration saw the first part only; all that is counted is later.
"""

import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from voltcam_lab.distances import FrameLight, Region
from voltcam_lab.distances.counts import in_still_light
from voltcam_lab.evaluation.later import change_of
from voltcam_lab.health import inspect
from voltcam_lab.light.grey import USUAL_DARK_DN
from voltcam_lab.light.scene import scene_of
from voltcam_lab.models.model import MODELS, simulate
from voltcam_lab.recordings import load
from voltcam_simulator import Parameters
from voltcam_simulator.effect import Events

DATA = Path(os.environ.get("VOLTCAM_DATA", Path(__file__).parents[3] / "shared" / "data"))
RECORDINGS = {"davis240c": "slider_depth", "davis346": "davis346_street/davis346.aedat4"}
FRAMES = {
    "slider_depth": {"input_response": {"pedestal_dn": 9.63, "white_level_dn": 113.0, "highlight": 1.344}},
    "davis346.aedat4": {"input_response": {"highlight": 1.261}},
}
"""What a camera's frames are that the preset, which sees light, does not have."""
PUBLISHED = {"davis240c": ("paper240c",), "davis346": ("paper", "typical")}
QUIET, SEED = 0.25, 1


@dataclass(frozen=True)
class Totals:
    """Events of the later part. quiet: of quiet pixels. still: at pixels while their light stands still."""

    on: int
    off: int
    quiet: int
    still: int


def quiet_pixels(light: FrameLight, since_us: int) -> NDArray[np.bool_]:
    """(H, W): the quarter of the pixels whose light changes least from frame to frame, all changes of ln L
    added up."""
    images = light.images[light.t_us >= since_us].astype(np.float64)
    change = np.abs(np.diff(np.log(images + USUAL_DARK_DN), axis=0)).sum(axis=0)
    quiet: NDArray[np.bool_] = change <= np.quantile(change, QUIET)
    return quiet


def totals(events: Events, region: Region, light: FrameLight, quiet: NDArray[np.bool_]) -> Totals:
    """Of all events in a region."""
    inside = region.of(events)
    on = int(np.count_nonzero(inside["p"]))
    still = len(in_still_light(events, region, light))
    return Totals(on, inside.size - on, len(region.on(quiet).of(events)), still)


def counted(path: Path, cameras: tuple[str, ...], seed: int = SEED) -> Iterator[tuple[str, Totals]]:
    """Of the recording itself, called "real", then of each camera."""
    inspection = inspect(load(path))
    footage = inspection.footage
    light = FrameLight(footage.frames, footage.frame_t_us)
    whole = Region.whole(footage.width, footage.height, change_of(footage), int(footage.frame_t_us[-1]))
    region, quiet = whole.on(~inspection.hot), quiet_pixels(light, change_of(footage))
    yield "real", totals(footage.events, region, light, quiet)
    scene = scene_of(footage.frames, footage.frame_t_us, "auto")
    for name in cameras:
        parameters = Parameters.of(name).changed(FRAMES.get(path.name, {}))
        model = MODELS["exact"](footage.width, footage.height, parameters, seed)
        yield name, totals(simulate(model, scene), region, light, quiet)


def main() -> int:
    """Print a table; 1 where a camera's totals are off by more than a quarter, or its quiet pixels' by 2."""
    print("| recording, later part | ON | OFF | quiet pixels | still light |\n|---|---|---|---|---|")  # noqa: T201
    good = True
    for preset, recording in RECORDINGS.items():
        real: Totals | None = None
        for name, found in counted(DATA / recording, (preset, *PUBLISHED[preset])):
            real = real or found
            ratios = {key: value / vars(real)[key] for key, value in vars(found).items()}
            cells = [f"{value} ({ratios[key]:.2f})" for key, value in vars(found).items()]
            print(f"| {recording}, {name} | {' | '.join(cells)} |", flush=True)  # noqa: T201
            if name == preset:
                near = max(abs(ratios["on"] - 1), abs(ratios["off"] - 1)) <= 0.25
                good &= near and 0.5 <= ratios["quiet"] <= 2
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
