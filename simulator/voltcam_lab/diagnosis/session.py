"""A recording made ready for diagnosis: what of it is looked at, and all that the search asks for."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Camera, Parameters

from ..health import EventsLate, Finding, Health, Inspection
from ..light.between_frames import calm, frame_noise2, scene_between, untrusted_share
from ..light.scale import white_dn
from ..light.scene import Scene
from ..light.unrounded import rounding_errors, unrounded
from ..recordings import Footage
from ..statistics import Values, setting_of
from .catalogue.candidate import Candidate
from .catalogue.clues import Clues
from .catalogue.entries import ENTRIES, event_delay_us
from .catalogue.entry import Entry
from .rig.clock import counted_from, origin_us
from .rig.lights import known_light
from .rig.part import cut, in_columns, sample
from .rig.settings import DEFAULT_RECORDING, DEFAULT_RIG, RecordingSettings, RigSettings
from .rig.stored import StoredRig
from .rig.whole import WholeSensor


class DiagnosisError(ValueError):
    """A recording that cannot be diagnosed: what is wrong with it and what to do, in one line."""


@dataclass(frozen=True, eq=False)
class Session:
    """All that a search asks for, and what was looked at.

    recording: of the sample only, x counted in `columns` (those of the sensor that it has). sensor: all of
    its columns, for what needs no statistics of simulated light. given: the camera file, of the recording's
    size. camera: what the search starts from, the given one or one with less in it. left_out: effects that
    are in `camera`, or cannot show in the sample. origin_us: where the clock of all this begins, on that of
    the recording and of camera files.
    """

    name: str
    recording: Footage
    sensor: WholeSensor
    given: Camera
    camera: Camera
    health: Health
    columns: NDArray[np.int64]
    rig: StoredRig
    data: Values
    candidates: tuple[Candidate, ...]
    left_out: tuple[str, ...]
    seed: int
    origin_us: int

    @property
    def parameters(self) -> Parameters:
        """The camera file's, on the clock of the diagnosis: where the search starts."""
        return self.on_clock(self.camera.parameters)

    @property
    def taken_out(self) -> tuple[str, ...]:
        """Effects of the given file that `camera` has not: without them known light is better explained."""
        return missing_in(self.camera.parameters, self.given.parameters)

    def on_clock(self, parameters: Parameters) -> Parameters:
        """A camera file's parameters on the clock of the diagnosis."""
        return counted_from(parameters, self.origin_us)

    @property
    def seconds(self) -> float:
        """Of the recording that are looked at."""
        t_us = self.rig.setting.scene.t_us
        return float(t_us[-1] - t_us[0]) * 1e-6

    @property
    def whole(self) -> bool:
        """Whether all columns of the sensor are looked at."""
        return len(self.columns) == self.camera.width

    def looked_at(self) -> str:
        """In words."""
        shown, height, all_columns = len(self.columns), self.recording.height, self.camera.width
        pixels = f"all {shown} x {height} pixels" if self.whole else (
            f"{shown} of {all_columns} columns ({_spans(self.columns)}), all {height} rows"
        )  # fmt: skip
        return (
            f"{self.seconds:.2f} s, {pixels}, {len(self.recording.events)} events,"
            f" {len(self.rig.setting.frame_t_us)} frames{self._known()}"
        )

    def _known(self) -> str:
        events = self.recording.events
        share = len(self.rig.in_trusted_light(events)) / len(events)
        known = self.rig.setting.known.gaps.mean()
        if share > 0.95:
            return ""
        where = f"{known:.0%} of pixels and time, with {share:.1%} of the events"
        return f"; light between frames is known for {where}"


def missing_in(parameters: Parameters, given: Parameters) -> tuple[str, ...]:
    """Effects that are on in the given parameters and not in these."""
    here = {effect.name for effect in parameters.effects() if effect.active}
    return tuple(effect.name for effect in given.effects() if effect.active and effect.name not in here)


def session_of(
    inspection: Inspection, camera: Camera, folder: Path, *, name: str = "the recording", seed: int = 0,
    processes: int = 1, entries: Sequence[Entry] = ENTRIES, settings: RecordingSettings = DEFAULT_RECORDING,
    rig_settings: RigSettings = DEFAULT_RIG,
) -> Session:  # fmt: skip
    """Make a recording that was inspected ready; runs go to `folder`, made by so many processes. entries:
    the catalogue of effects that are looked for.

    Raises DiagnosisError where a diagnosis makes no sense.
    """
    fatal = [finding for finding in inspection.health.fatal if not _may_wait(finding, settings)]
    if fatal:
        raise DiagnosisError(f"{name}: {'; '.join(finding.words for finding in fatal)}")
    origin, recording = origin_us(inspection.footage), cut(inspection.footage, settings)
    if len(recording.frames) < settings.fewest_frames:
        raise DiagnosisError(
            f"{name} has fewer than {settings.fewest_frames} frames in {settings.seconds:g} s: "
            "give more of it"
        )
    if not len(recording.events):
        raise DiagnosisError(f"{name} has no events while there are frames: are both on one clock?")
    camera = camera.model_copy(update={"width": recording.width, "height": recording.height})
    parameters = counted_from(camera.parameters, origin)
    columns = sample(recording, settings, parameters.longest_step_us)
    sensor = whole_sensor(recording, settings, rig_settings, seed)
    scene = (
        sensor.scene.in_columns(columns)
        if len(sensor.footage.frames) == len(recording.frames)
        else best_scene(recording.frames, recording.frame_t_us, columns, settings.noisy_dn2)
    )
    part = in_columns(recording, columns)
    setting = setting_of(
        scene, recording.frame_t_us, None, recording.exposure_us, parameters, known_light(scene, part.events)
    )
    rig = StoredRig(setting, folder, seed, rig_settings, processes=processes)
    known = len(rig.in_trusted_light(part.events))
    if known < settings.fewest_events:
        raise DiagnosisError(
            f"{name}: of {len(part.events)} events {known} are where the light between frames is known: take "
            "frames more often, or move slower"
        )
    clues = Clues(setting, part.events, inspection.row_time_us, event_delay_us(parameters))
    wanted: list[Candidate] = []
    left_out: list[Candidate] = []
    for entry in entries:
        hidden = entry.needs_all_columns and len(columns) < recording.width
        for one in entry.candidates(clues):
            if hidden or one.is_on(parameters):
                left_out.append(one)
            else:
                wanted.append(entry.tuned(rig, parameters, one, part.events))
    return Session(
        name, part, sensor, camera, camera, inspection.health, columns, rig, rig.observe(part.events),
        tuple(wanted),
        tuple(dict.fromkeys(one.effect for one in left_out)), seed, origin,
    )  # fmt: skip


def whole_sensor(
    recording: Footage, settings: RecordingSettings, rig_settings: RigSettings, seed: int
) -> WholeSensor:
    """All columns of a recording, from its beginning, as long as its light fits into memory."""
    frames = min(len(recording.frames), max(2, settings.most_whole_samples // recording.frames[0].size))
    t_us, events = recording.frame_t_us[:frames], recording.events
    part = replace(
        recording,
        frames=recording.frames[:frames],
        frame_t_us=t_us,
        exposure_us=None if recording.exposure_us is None else recording.exposure_us[:frames],
        events=events[events["t"] <= t_us[-1]],
    )
    columns = np.arange(recording.width)
    light = partial(best_scene, part.frames, t_us, columns, settings.noisy_dn2)
    return WholeSensor(part, light, rig_settings, seed)


def best_scene(
    frames: NDArray[Any], t_us: NDArray[np.int64], columns: NDArray[np.int64], noisy_dn2: float
) -> Scene:
    """The light between frames in some columns, by the way of filling in that is trusted most often.

    Of frames in whole grey levels it has what rounding may have hidden.

    noisy_dn2: `RecordingSettings.noisy_dn2`.
    """
    noise2, rounding, white = frame_noise2(frames), None, white_dn(frames)
    if noise2 > noisy_dn2:
        frames = calm(frames, noise2)
    elif np.issubdtype(frames.dtype, np.integer):
        frames = unrounded(frames)
        rounding = rounding_errors(frames)[..., columns]
    scene = scene_between(frames, t_us, columns, untrusted_share, white)
    if scene.on_curves:
        scene = scene.out_of_step()
    return scene if rounding is None else scene.with_rounding(rounding)


def _may_wait(finding: Finding, settings: RecordingSettings) -> bool:
    """Whether what looks like another clock may be events that queue: to tell these is for the diagnosis."""
    return isinstance(finding, EventsLate) and 0 < finding.late_us < settings.longest_wait_us


def _spans(columns: NDArray[np.int64]) -> str:
    runs = np.split(columns, np.flatnonzero(np.diff(columns) > 1) + 1)
    return " and ".join(f"{run[0]} to {run[-1]}" for run in runs)
