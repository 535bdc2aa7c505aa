"""What the camera's own frames do to its events: exposure and readout of rows, fitted by simulation.

This needs stamps and polarities only: how many events come at each phase of the frame, row by row.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters
from voltcam_simulator.effect import Events

from ..health import Inspection
from ..health.exposure_times import exposure_times
from ..light.scene import Scene
from ..models.model import MODELS, simulate
from ..models.run_up import run_up
from ..recordings import Footage

PHASE_US = 400.0  # about an exposure: when within it events leave is the bus's affair
BANDS = 6  # of rows, which tell a scan from what is everywhere at once
FIRST = (0.02, 0.06, 0.18, -0.02, -0.06, -0.18)  # kicks, in nominal thresholds
FACTORS = (1.6, 1.2)  # by which the best is made larger and smaller
SHIFTS_US = (100.0, 30.0)  # by which an exposure is moved, and made longer and shorter
WORTH_IT = 0.1  # of the excess over chance that a kick must take away to be kept
NO_ROWS_US = 0.01  # time of a row where no scan is seen: all at once
DEFAULT_EXPOSURE_US = 500.0
LEAD_IN_US, LEAD_IN_FRAMES = 1_000_000, 60  # before a scene begins: by then what can fire at once has fired
KICKS = ("exposure_kick", "reset_kick", "readout_kick")


@dataclass(frozen=True, eq=False)
class PhaseGoal:
    """The recording's events by polarity, band of rows and phase of the frame."""

    period_us: float
    origin_us: float
    height: int
    counts: NDArray[np.float64]

    @classmethod
    def of(cls, footage: Footage) -> "PhaseGoal":
        """Of a recording."""
        t_us = footage.frame_t_us
        period_us = float(t_us[-1] - t_us[0]) / (len(t_us) - 1)
        empty = cls(period_us, float(t_us[0]), footage.height, np.zeros(0))
        return cls(period_us, float(t_us[0]), footage.height, empty.counted(footage.events))

    def counted(self, events: Events) -> NDArray[np.float64]:
        """(2 x BANDS x phases,). An event between two phases counts for both in part, so that a burst at
        the edge of one may come a little sooner or later."""
        phases = max(8, int(self.period_us / PHASE_US))
        place = ((events["t"] - self.origin_us) % self.period_us) / self.period_us * phases
        band = events["y"].astype(np.int64) * BANDS // self.height
        first = (events["p"] * BANDS + band) * phases
        before = np.minimum(place.astype(np.int64), phases - 1)
        size, share = 2 * BANDS * phases, place - before
        counts = np.bincount(first + before, 1 - share, size) + np.bincount(
            first + (before + 1) % phases, share, size
        )
        return np.asarray(counts, np.float64)

    def excess(self, events: Events) -> float:
        """Squared difference of the roots of the counts, four times, less what chance alone makes of it:
        about 0 where the frames' phase tells nothing apart. Each polarity and band by shares, so that the
        scene's own numbers do not count."""
        real = self.counts.reshape(2 * BANDS, -1)
        other = self.counted(events).reshape(2 * BANDS, -1)
        other = other * (real.sum(axis=1) / np.maximum(other.sum(axis=1), 1.0))[:, None]
        return float(4 * np.sum((np.sqrt(other + 0.375) - np.sqrt(real + 0.375)) ** 2)) - 2 * real.size


def with_frames_of(
    inspection: Inspection, scene: Scene, footage: Footage, parameters: Parameters, seed: int,
    report: Callable[[str], None] = lambda step: None,
) -> tuple[Parameters, str | None]:  # fmt: skip
    """The parameters with `aps_coupling` as the recording shows it, and what was found, in words; as they are
    and None where events do not come with the frames.

    footage, scene: of all rows of the sensor, and of the same time. Kick after kick is tried, made larger and
    smaller, and kept where it takes away a tenth of what the phase of the frame tells apart. An exposure that
    has one is moved to where its events are; its length too, where the file does not tell it.
    """
    if not inspection.bursts:
        return parameters, None
    goal = PhaseGoal.of(footage)
    times = _times(inspection, footage, parameters, goal.period_us)

    def excess(frame: Mapping[str, float]) -> float:
        report("frames")
        return goal.excess(filmed(footage, scene, parameters.changed({"aps_coupling": frame}), seed))

    frame = times | dict.fromkeys(KICKS, 0.0)
    least = before = excess(frame)
    for name in KICKS if inspection.row_time_us is not None else KICKS[:1]:
        best, size = min((excess({**frame, name: size}), size) for size in FIRST)
        if best < least - WORTH_IT * max(before, 0.0):
            frame[name], least = size, best
    if frame["exposure_kick"]:
        told = footage.exposure_us is not None
        for by_us in SHIFTS_US:
            for name in ("offset_us",) if told else ("offset_us", "exposure_us"):
                frame, least = _best(excess, frame, least, name, (frame[name] - by_us, frame[name] + by_us))
    for factor in FACTORS:
        for name in KICKS:
            if size := frame[name]:
                frame, least = _best(excess, frame, least, name, (size / factor, size * factor))
    if least >= before:
        return parameters, None
    said = ", ".join(f"{name} {frame[name]:+.3g}" for name in KICKS if frame[name])
    words = (
        f"the camera's frames make events: {said}; they leave {max(least, 0) / before:.0%} of what they do"
    )
    return parameters.changed({"aps_coupling": {name: round(x, 4) for name, x in frame.items()}}), words


def _best(
    excess: Callable[[Mapping[str, float]], float], frame: dict[str, float], least: float, name: str,
    values: tuple[float, float],
) -> tuple[dict[str, float], float]:  # fmt: skip
    """(The frame with one of these values, its excess) where that is less than the least so far."""
    tried = [
        (excess({**frame, name: value}), value) for value in values if name != "exposure_us" or value > 0
    ]
    best, value = min(tried)
    return ({**frame, name: value}, best) if best < least else (frame, least)


def filmed(footage: Footage, scene: Scene, parameters: Parameters, seed: int) -> Events:
    """The events of a camera that has seen the like, and taken frames, for long when the scene begins. Else
    pixels near a threshold, and those that noise of the frames takes there, fire first and not again."""
    model, begin_us = MODELS["exact"](footage.width, footage.height, parameters, seed), int(scene.t_us[0])
    filming_us = round(LEAD_IN_FRAMES * parameters.aps_coupling.frame_period_us)
    for image, t_us in run_up(scene.images, scene.t_us.tolist(), LEAD_IN_US, filming_us):
        model.advance(image, t_us)
    events = simulate(model, scene)
    kept: Events = events[events["t"] > begin_us]
    return kept


def _times(
    inspection: Inspection, footage: Footage, parameters: Parameters, period_us: float
) -> dict[str, float]:
    """When frames are taken, on the pixels' clock: events are late by the camera's own delay."""
    row_us = abs(inspection.row_time_us or NO_ROWS_US)
    period_us = round(period_us, 3)  # as the camera has it: a clock may be 10^10 periods from its zero
    begin_us, told_us = exposure_times(footage.events, footage.frame_t_us, footage.exposure_us, row_us)
    begin_us -= parameters.latency.delay_us + footage.height * row_us
    return {
        "frame_period_us": period_us,
        "exposure_us": round(DEFAULT_EXPOSURE_US if told_us is None else told_us, 1),
        "row_us": round(row_us, 3),
        "offset_us": round(begin_us % period_us, 1),
    }
