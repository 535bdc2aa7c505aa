"""A recording in, a camera file out: what `voltcam calibrate` does, without its command line."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import yaml

from voltcam_simulator import Camera, Parameters
from voltcam_simulator.camera_file import INTERVALS
from voltcam_simulator.effect import Events
from voltcam_simulator.effects.junction_leak import arrhenius

from ..distances import FrameLight, Region
from ..health import Health, Inspection
from ..light.between_frames import scene_between
from ..light.scene import Scene
from ..recordings import Footage
from ..windows import Mask
from .bus import as_read
from .calibrate import Calibration, CalibrationError, calibrate
from .camera_frames import filmed, with_frames_of
from .estimates import Estimate
from .lateness import as_late_as, clocks_apart_us
from .paper_method import calibrate_as_paper
from .reading import Reading
from .refine.refine import Refined, known_share, refine
from .scatter import as_scattered

Method = Literal["exact", "paper"]
SIMULATED = 25e6  # pixels times images of light: as much as the command has time for
EXACT = ("frame_period_us", "offset_us")
FEWEST_FRAMES = 10  # by which events are told to be late
MOSTLY_KNOWN = 0.5  # of the events: by fewer, parameters would make up for light that is not known
WORTH_IT = 0.9  # of the score, where parameters that behave more alike take the place of the likeliest
MOST_SAMPLES = (
    24_000_000  # pixels times frames that are fitted: about 1.5 GB; of more, the middle of the picture
)


@dataclass(frozen=True, eq=False)
class Calibrated:
    """camera: the result. estimates: what was fitted, with intervals that have the camera's
    values in them; none by the paper's method. refined:
    what was then moved for the camera to behave as the recording; None where nothing was. moved: these, as
    (effect.parameter, by likelihood, now). reading: what of the recording was looked at, all its pixels.
    notes: what a person should know, a line each."""

    camera: Camera
    method: Method
    health: Health
    estimates: tuple[Estimate, ...]
    calibration: Calibration | None
    refined: Refined | None
    moved: tuple[tuple[str, float, float], ...]
    reading: Reading
    mask: Mask
    notes: tuple[str, ...]

    def to_yaml(self, source: str) -> str:
        """The camera file, with what it rests on at its top. source: name of the recording."""
        lines = [f"# Calibrated by `voltcam calibrate` ({self.method} law) from {source}."]
        lines += [f"# {note}" for note in self.notes]
        content: dict[str, Any] = self.camera.model_dump(exclude={"parameters"})
        content |= _rounded(self.camera.parameters.model_dump(exclude_defaults=True))
        lines.append(yaml.safe_dump(content, sort_keys=False).rstrip())
        if self.estimates:
            lines += [
                "# 90 % intervals by likelihood, widened to what a parameter was moved to; and what fixes",
                "# each, data or only the prior (nothing much):",
                f"{INTERVALS}:",
            ]
        for one in self.estimates:
            interval = f"  {one.effect}.{one.parameter}: [{one.low:.3g}, {one.high:.3g}]"
            lines.append(f"{interval:<60}# {one.rests_on}")
        return "\n".join([*lines, ""])


def camera_from(
    inspection: Inspection,
    *,
    name: str = "camera",
    method: Method = "exact",
    base: Camera | None = None,
    temperature_c: float | None = None,
    seed: int = 0,
    refining: bool = True,
    report: Callable[[str], None] = lambda step: None,
) -> Calibrated:
    """The camera that made a recording that was inspected.

    base: a camera whose other effects are taken over, of the recording's size. temperature_c: of the die
    while it was recorded. refining: the exact law's parameters are moved until simulated events are most like
    the recorded ones, if they gain by it and light is known for most of them. Raises CalibrationError, a
    line, where the recording is of no use.
    """
    recording = inspection.footage
    size = (recording.width, recording.height)
    if base is not None and (base.width, base.height) != size:
        raise CalibrationError(
            f"{base.name} has {base.width}x{base.height} pixels, the recording {size[0]}x{size[1]}: omit "
            "--camera, or give the camera that recorded it"
        )
    health = inspection.health
    if not health.usable:
        raise CalibrationError("; ".join(finding.words for finding in health.fatal))
    report("light between frames")
    cut = _middle(recording)
    mask, keep = inspection.mask.from_row(cut[0].start), ~inspection.hot[cut]
    scene = scene_between(recording.frames[:, *cut], recording.frame_t_us)
    reading = Reading(_within(recording, cut), scene, keep, mask)
    notes = _notes(reading, recording.frames.shape[1:])
    found: Calibration | None = None
    refined: Refined | None = None
    moved: tuple[tuple[str, float, float], ...] = ()
    estimates: tuple[Estimate, ...] = ()
    if method == "paper":
        try:
            fitted = calibrate_as_paper(reading.events, reading.scene, reading.keep, mask)
        except ValueError as error:
            raise CalibrationError(str(error)) from error
        parameters, notes = fitted.parameters, notes + list(fitted.notes)
    else:
        found = calibrate(reading, seed, report, clocks_apart_us(inspection.lag))
        estimates = found.estimates
        notes += _notes_of(found)
        alone = base.parameters.changed(_own(found.parameters)) if base and refining else found.parameters
        parameters, said = _with_camera(inspection, reading, cut, alone, seed, report)
        if refining and (share := known_share(reading.events, scene)) < MOSTLY_KNOWN:
            notes.append(
                f"parameters are the likeliest, not moved by simulation: {share:.0%} of the events come "
                "where light between frames is known: record slower motion, or at a higher frame rate"
            )
        elif refining:
            refined = _refined(inspection, reading, cut, parameters, seed, report)
            worth = refined.after < WORTH_IT * refined.before
            notes.append(_told(refined, worth))
            if worth:  # what frames do is fitted to the pixels as they are now
                likeliest = parameters
                pixels = refined.parameters.changed({"aps_coupling": alone.aps_coupling.model_dump()})
                parameters, said = _with_camera(inspection, reading, cut, pixels, seed, report)
                moved = _moved(likeliest, parameters)
        estimates = tuple(
            one.reaching(getattr(getattr(parameters, one.effect), one.parameter)) for one in estimates
        )
        notes += said
    known: dict[str, Any] = _own(parameters) | _faulty(inspection)
    if temperature_c is not None:
        known["temperature_c"] = temperature_c
        known["junction_leak"] = {"k4_per_us": _at_reference(parameters, temperature_c)}
    camera = Camera(
        name=name,
        width=size[0],
        height=size[1],
        parameters=(base.parameters if base else Parameters()).changed(known),
    )
    return Calibrated(camera, method, health, estimates, found, refined, moved, reading, mask, tuple(notes))


def _own(parameters: Parameters) -> dict[str, Any]:
    return parameters.model_dump(exclude_defaults=True)


def _refined(
    inspection: Inspection,
    reading: Reading,
    cut: tuple[slice, slice],
    start: Parameters,
    seed: int,
    report: Callable[[str], None],
) -> Refined:
    """The camera will see other scenes, so light is what it is there: frames, and what is between them.

    Where what frames do to events is in the parameters, events about exposures count as all others. Else
    they are left out.
    """
    scene, frames, t_us = reading.scene, inspection.footage.frames, inspection.footage.frame_t_us
    whole = Region.whole(scene.width, scene.height, int(t_us[0]), int(t_us[-1]))
    region = whole.on(reading.keep)
    if not start.aps_coupling.active:
        region = region.without(inspection.exposure_windows)
    light = FrameLight(np.asarray(frames[:, *cut], np.uint8), t_us)
    return refine(
        reading.events, scene, light, region, start, seed, report, same_light=True, longest=SIMULATED
    )


def _with_camera(
    inspection: Inspection,
    reading: Reading,
    cut: tuple[slice, slice],
    parameters: Parameters,
    seed: int,
    report: Callable[[str], None],
) -> tuple[Parameters, list[str]]:
    """What is the camera's and not the pixels': how late its events are, what its frames do to them, and how
    they are read; with what was found, in words."""
    report("delay")
    parameters, notes = as_read(inspection, parameters)
    footage, scene = _shortened(inspection.footage, reading, cut)
    parameters, late = as_late_as(footage, scene, parameters, seed)
    notes.append(late)
    rows, columns = cut
    if (rows.stop - rows.start, columns.stop - columns.start) == inspection.footage.frames.shape[1:]:
        parameters, frames = with_frames_of(inspection, scene, footage, parameters, seed, report)
        if frames:
            simulated = filmed(footage, scene, parameters, seed)
            parameters, scatter = as_scattered(footage, simulated, parameters)
            notes += [frames, scatter] if scatter else [frames]
    else:
        notes.append(
            "what the camera's frames do was not fitted: of so long a recording only the middle is looked at"
        )
    return parameters, notes


def _shortened(footage: Footage, reading: Reading, cut: tuple[slice, slice]) -> tuple[Footage, Scene]:
    """What is simulated, from its beginning: SIMULATED at most, and a few frames at least."""
    scene = reading.scene
    images = max(int(SIMULATED / (scene.width * scene.height)), 2)
    end_us = max(int(scene.t_us[:images][-1]), int(scene.taken_us[:FEWEST_FRAMES][-1]))
    taken, filled = scene.taken_us <= end_us, scene.t_us <= end_us
    end_us = int(scene.taken_us[taken][-1])
    part = replace(
        footage,
        events=reading.events[reading.events["t"] <= end_us],
        width=scene.width,
        height=scene.height,
        frames=footage.frames[taken][:, *cut],
        frame_t_us=footage.frame_t_us[taken],
        exposure_us=None if footage.exposure_us is None else footage.exposure_us[taken],
    )
    light = replace(
        scene, taken=scene.taken[taken], taken_us=scene.taken_us[taken], images=scene.images[filled],
        t_us=scene.t_us[filled],
    )  # fmt: skip
    return part, light


def _moved(before: Parameters, after: Parameters) -> tuple[tuple[str, float, float], ...]:
    """What differs by more than a thousandth, by name."""
    found = []
    old, new = before.model_dump(), after.model_dump()
    for effect, values in new.items():
        for name, value in (values if isinstance(values, dict) else {}).items():
            former = old[effect][name]
            if isinstance(value, float) and abs(value - former) > 1e-3 * max(abs(value), abs(former)):
                found.append((f"{effect}.{name}", float(former), value))
    return tuple(found)


def _told(refined: Refined, worth: bool) -> str:
    score = f"{refined.before:.3g} to {refined.after:.3g} on pixels that no step was judged by (0: the same)"
    if not worth:
        return f"parameters are the likeliest: others that were tried behave no more alike, {score}"
    return f"parameters were moved to behave as the recording does: difference from {score}"


def _at_reference(parameters: Parameters, temperature_c: float) -> float:
    """k4 at the temperature it is given at, of one fitted at temperature_c."""
    leak = parameters.junction_leak
    return float(leak.k4_per_us / arrhenius(temperature_c, leak.activation_energy_ev))


def _middle(recording: Footage) -> tuple[slice, slice]:
    """Rows and columns from the middle of the picture, such that there are MOST_SAMPLES at most."""
    frames = len(recording.frames)
    share = min(1.0, (MOST_SAMPLES / (frames * recording.width * recording.height)) ** 0.5)
    spans = []
    for side in (recording.height, recording.width):
        length = max(int(side * share), 1)
        spans.append(slice((side - length) // 2, (side - length) // 2 + length))
    return spans[0], spans[1]


def _within(recording: Footage, cut: tuple[slice, slice]) -> Events:
    rows, columns = cut
    x, y = recording.events["x"], recording.events["y"]
    inside = (y >= rows.start) & (y < rows.stop) & (x >= columns.start) & (x < columns.stop)
    events: Events = recording.events[inside].copy()
    events["x"] -= columns.start
    events["y"] -= rows.start
    return events


def _faulty(inspection: Inspection) -> dict[str, dict[str, float]]:
    """Hot and dead pixels, as changes of parameters."""
    hot, silent, t_us = inspection.hot, inspection.silent, inspection.footage.events["t"]
    found: dict[str, dict[str, float]] = {}
    if hot.any():
        rates = inspection.subject.all_counts[hot] / (float(t_us[-1] - t_us[0]) / 1e6)
        found["hot_pixels"] = {"fraction": float(hot.mean()), "rate_hz": float(np.median(rates))}
    if silent.any():
        found["dead_pixels"] = {"fraction": float(silent.mean())}
    return found


def _notes(reading: Reading, size: tuple[int, ...]) -> list[str]:
    scene = reading.scene
    seconds = (scene.taken_us[-1] - scene.taken_us[0]) / 1e6
    notes = [f"{len(scene.taken)} frames and {len(reading.events)} events in {seconds:.1f} s"]
    if scene.taken.shape[1:] != size:
        notes[0] += f", of the middle {scene.width}x{scene.height} pixels of {size[1]}x{size[0]}"
    return notes


def _notes_of(found: Calibration) -> list[str]:
    notes = [
        f"fitted to {found.events} intervals between events of a pixel; {found.fit.own:.0%} of these are "
        f"as the model has them; light trusted to {found.reading.tolerance:.0%}"
    ]
    for (first, second), value in found.correlations.items():
        notes.append(f"{first} and {second} are correlated {value:+.2f}")
    guessed = [f"{one.effect}.{one.parameter}" for one in found.estimates if one.rests_on == "prior"]
    if guessed:
        notes.append(
            f"not determined by this recording, any value in the interval will do: {', '.join(guessed)}"
        )
    return notes


def _rounded(value: Any) -> Any:
    """Floats to four digits, in nested mappings; times of frames as they are, since their errors add up."""
    if isinstance(value, dict):
        return {key: one if key in EXACT else _rounded(one) for key, one in value.items()}
    return float(f"{value:.4g}") if isinstance(value, float) else value
