"""A recording made ready for diagnosis: what of it is looked at, and all that the search asks for."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_client.formats import Recording
from voltcam_simulator import Camera, Parameters

from ..battery import setting_of
from ..grey_levels import unrounded
from ..health import Finding, Health, examine
from ..light_between import calm, frame_noise2
from ..scene import Scene, scene_of
from .catalogue import Asymmetry, Candidate, catalogue
from .clues import clues, in_step
from .model import Model
from .rig import Values
from .stored import StoredRig

MOST_SAMPLES = 3_500_000  # pixels x frames, all of 60 x 60 pixels for 10 s at 100 frames/s
MOST_EVENTS = 200_000
MOST_STEPS = 15_000_000  # pixels x steps that effects of the camera file ask the simulator for
MOST_SECONDS = 10.0
FEWEST_FRAMES = 10
LONGEST_WAIT_US = 100_000  # of events before a readout that is too slow
NOISY_DN2 = 0.15  # variance: rounding has 1/12
_TRUSTED = 0.9
_CLOCK_US = 4_032_000  # a multiple of all ticks a camera may have: stamps stay as divisible as they are


class DiagnosisError(ValueError):
    """A recording that cannot be diagnosed: what is wrong with it and what to do, in one line."""


@dataclass(frozen=True, eq=False)
class Session:
    """All that `loop.diagnose` asks for, and what was looked at.

    recording: of the sample only, x counted in `columns` (those of the sensor that it has). camera: as given,
    of the recording's size. left_out: effects that are in the camera file, or cannot show in the sample.
    taken_out: effects that were in the file, not in `camera`: without them the recording is better explained.
    """

    name: str
    recording: Recording
    camera: Camera
    health: Health
    columns: NDArray[np.int64]
    rig: StoredRig
    data: Values
    candidates: tuple[Candidate, ...]
    left_out: tuple[str, ...]
    seed: int
    taken_out: tuple[str, ...] = ()

    @property
    def model(self) -> Model:
        """Where the search starts."""
        return Model(self.camera.parameters)

    @property
    def seconds(self) -> float:
        """Of the recording that are looked at."""
        t_us = self.rig.setting.scene.t_us
        return float(t_us[-1] - t_us[0]) * 1e-6

    def looked_at(self) -> str:
        """In words."""
        shown, height, all_columns = len(self.columns), self.recording.height, self.camera.width
        pixels = f"all {shown} x {height} pixels" if shown == all_columns else (
            f"{shown} of {all_columns} columns ({_spans(self.columns)}), all {height} rows"
        )  # fmt: skip
        return (
            f"{self.seconds:.2f} s, {pixels}, {len(self.recording.events)} events,"
            f" {len(self.rig.setting.frame_t_us)} frames"
        )


def session_of(
    recording: Recording, camera: Camera, folder: Path, *, name: str = "the recording", seed: int = 0,
    seconds: float = MOST_SECONDS, most_samples: int = MOST_SAMPLES, processes: int = 1,
) -> Session:  # fmt: skip
    """Make a recording (as voltcam_lab.recordings.load gives it) ready; runs go to `folder`, made by
    so many processes.

    Raises DiagnosisError where a diagnosis makes no sense.
    """
    health = examine(recording)
    fatal = [finding for finding in health.fatal if not _may_wait(finding)]
    if fatal:
        raise DiagnosisError(f"{name}: {'; '.join(finding.words for finding in fatal)}")
    recording = cut(recording, seconds)
    if recording.frames is None or recording.frame_t_us is None or len(recording.frames) < FEWEST_FRAMES:
        raise DiagnosisError(
            f"{name} has fewer than {FEWEST_FRAMES} frames in {seconds:g} s: give more of it"
        )
    camera = camera.model_copy(update={"width": recording.width, "height": recording.height})
    columns = sample(recording, most_samples, camera.parameters.longest_step_us)
    scene = seen(recording.frames, recording.frame_t_us, columns)
    part = in_columns(recording, columns)
    if not len(part.events):
        raise DiagnosisError(f"{name} has no events while there are frames: are both on one clock?")
    setting = setting_of(scene, recording.frame_t_us, None, recording.exposure_us, camera.parameters)
    rig = StoredRig(setting, folder, seed, processes=processes)
    row_us = health["row readout"].numbers["us_per_row"]
    wanted: list[Candidate] = []
    left_out: list[Candidate] = []
    for one in catalogue(clues(setting, part.events, row_us)):
        off_axis = one.effect == "vignetting" and len(columns) < recording.width
        off = off_axis or _is_on(one, camera.parameters)
        if one.effect == "flicker" and not off:
            one = in_step(rig, camera.parameters, one, part.events)
        (left_out if off else wanted).append(one)
    return Session(
        name, part, camera, health, columns, rig, rig.observe(part.events), tuple(wanted),
        tuple(dict.fromkeys(one.effect for one in left_out)), seed,
    )  # fmt: skip


def cut(recording: Recording, seconds: float) -> Recording:
    """The first seconds of it, events between its first and last frame, on a clock that begins near there."""
    assert recording.frame_t_us is not None
    assert recording.frames is not None
    origin_us = recording.frame_t_us[0] // _CLOCK_US * _CLOCK_US
    kept = recording.frame_t_us <= recording.frame_t_us[0] + seconds * 1e6
    frame_t_us, t_us = recording.frame_t_us[kept], recording.events["t"]
    events = recording.events[(t_us >= frame_t_us[0]) & (t_us <= frame_t_us[-1])].copy()
    events["t"] -= origin_us
    exposure_us = recording.exposure_us
    return replace(
        recording,
        frames=recording.frames[kept],
        frame_t_us=frame_t_us - origin_us,
        exposure_us=None if exposure_us is None else exposure_us[kept] - origin_us,
        events=events,
    )


def sample(recording: Recording, most_samples: int, step_us: float = np.inf) -> NDArray[np.int64]:
    """Columns to look at, ascending: all, or two strips, where light changes most and where it does little.

    As many as samples of light (pixels x frames), MOST_EVENTS, and MOST_STEPS of step_us allow. Rows are kept
    whole and complete, since readout goes by rows.
    """
    assert recording.frames is not None
    assert recording.frame_t_us is not None
    steps = recording.frames[0].size * float(np.ptp(recording.frame_t_us)) / step_us
    share = min(
        most_samples / recording.frames.size,
        MOST_EVENTS / max(len(recording.events), 1),
        MOST_STEPS / max(steps, 1.0),
    )
    wide = max(6, int(share * recording.width / 2))
    if share >= 1 or 3 * wide > recording.width:  # nearly all: then all
        return np.arange(recording.width)
    grey = recording.frames[:: max(1, len(recording.frames) // 50)].astype(np.float32)
    change = np.abs(np.diff(np.log(grey + 20), axis=0)).mean(axis=(0, 1))
    strips = change[: recording.width // wide * wide].reshape(-1, wide).mean(axis=1)
    order = np.argsort(-strips, kind="stable")
    chosen = sorted({int(order[0]), int(order[max(1, len(order) * 2 // 3)])})
    return np.concatenate([np.arange(wide) + wide * strip for strip in chosen])


def in_columns(recording: Recording, columns: NDArray[np.int64]) -> Recording:
    """The recording of a sensor that has only these columns."""
    place = np.full(recording.width, -1)
    place[columns] = np.arange(len(columns))
    events = recording.events[place[recording.events["x"]] >= 0].copy()
    events["x"] = place[events["x"]]
    assert recording.frames is not None
    return replace(recording, events=events, frames=recording.frames[:, :, columns], width=len(columns))


def seen(frames: NDArray[Any], t_us: NDArray[np.int64], columns: NDArray[np.int64]) -> Scene:
    """The light between frames, by whichever way of filling in tells them best; of some columns."""
    noise2 = frame_noise2(frames)
    if noise2 > NOISY_DN2:
        frames = calm(frames, noise2)
    elif np.issubdtype(frames.dtype, np.integer):
        frames = unrounded(frames)
    cubic = scene_of(frames[:, :, columns], t_us, "cubic")
    if cubic.trusted().mean() > _TRUSTED:
        return cubic
    auto = scene_of(frames, t_us, "auto")  # motion is seen in whole frames
    surprise = auto.surprise.reshape(len(t_us), auto.height, auto.width)[:, :, columns]
    auto = Scene(auto.taken[:, :, columns], t_us, auto.images[:, :, columns], auto.t_us, "auto")
    auto.__dict__["surprise"] = surprise.reshape(len(t_us), -1)  # its own would come from narrow strips
    return auto if auto.trusted().mean() > cubic.trusted().mean() else cubic


def _may_wait(finding: Finding) -> bool:
    """Whether what looks like another clock may be events that queue: to tell these is for the diagnosis."""
    late_us: float = finding.numbers.get("late_us", 0.0)
    return 0 < late_us < LONGEST_WAIT_US


def _is_on(candidate: Candidate, parameters: Parameters) -> bool:
    if isinstance(candidate, Asymmetry):
        return False
    effect, name = getattr(parameters, candidate.effect), candidate.names[0]
    return bool(effect.active and getattr(effect, name) != type(effect).model_fields[name].default)


def _spans(columns: NDArray[np.int64]) -> str:
    runs = np.split(columns, np.flatnonzero(np.diff(columns) > 1) + 1)
    return " and ".join(f"{run[0]} to {run[-1]}" for run in runs)
