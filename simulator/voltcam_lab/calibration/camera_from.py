"""A recording in, a camera file out: what `voltcam calibrate` does, without its command line."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]

from voltcam_simulator import Camera, Parameters
from voltcam_simulator.effects.junction_leak import arrhenius

from ..health import Inspection
from ..light.between_frames import scene_between
from .calibrate import CalibrationError
from .calibrated import Calibrated, Method
from .exact_method import ExactMethod
from .paper_method import calibrate_as_paper
from .part import events_within, middle
from .reading import Reading


# The order of sums, and so what is found, would depend on the number of threads.
@threadpool_limits.wrap(limits=1)  # type: ignore[untyped-decorator]
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
    cut = middle(recording)
    mask, keep = inspection.mask.from_row(cut[0].start), ~inspection.hot[cut]
    scene = scene_between(recording.frames[:, *cut], recording.frame_t_us)
    reading = Reading(events_within(recording, cut), scene, keep, mask)
    notes = _notes(reading, recording.frames.shape[1:])

    def calibrated(parameters: Parameters, said: Sequence[str], **found: Any) -> Calibrated:
        camera = _camera(name, size, base, parameters, inspection, temperature_c)
        return Calibrated(camera, method, health, reading, mask, (*notes, *said), **found)

    if method == "exact":
        exact = ExactMethod(inspection, reading, cut, seed, report)
        found = exact.found(base.parameters if base else None, refining)
        return calibrated(
            found.parameters, found.notes, estimates=found.estimates, calibration=found.calibration,
            refined=found.refined, moved=found.moved,
        )  # fmt: skip
    try:
        paper = calibrate_as_paper(reading.events, reading.scene, reading.keep, mask)
    except ValueError as error:
        raise CalibrationError(str(error)) from error
    return calibrated(paper.parameters, paper.notes)


def _camera(
    name: str, size: tuple[int, int], base: Camera | None, parameters: Parameters, inspection: Inspection,
    temperature_c: float | None,
) -> Camera:  # fmt: skip
    """What was found, on what is known of the camera before."""
    known = parameters.model_dump(exclude_defaults=True) | _faulty(inspection)
    if temperature_c is not None:
        known["temperature_c"] = temperature_c
        known["junction_leak"] = {"k4_per_us": _at_reference(parameters, temperature_c)}
    before = base.parameters if base else Parameters()
    return Camera(name=name, width=size[0], height=size[1], parameters=before.changed(known))


def _at_reference(parameters: Parameters, temperature_c: float) -> float:
    """k4 at the temperature it is given at, of one fitted at temperature_c."""
    leak = parameters.junction_leak
    return float(leak.k4_per_us / arrhenius(temperature_c, leak.activation_energy_ev))


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
