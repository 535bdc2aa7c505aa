"""Twins: recordings the model makes of the same scene, where the truth is known."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters, Simulator

from ..light.scene import Scene, scene_of
from .estimates import likelihood_parameters
from .fit import NAMES, Fit, maximise, named, possible
from .reading import Reading

TWINS = (4, 12)  # at the fit, and where these lead
PER_LIGHT = 2  # twins that see the same: light between frames costs as much as a twin
LEAST_SPREAD = 1e-4  # thresholds: nothing
Vector = NDArray[np.float64]


def unbiased(
    reading: Reading,
    fitted: Fit,
    dead_us: float,
    delay_us: float,
    seed: int,
    report: Callable[[str], None],
) -> tuple[Vector, Vector]:
    """Log parameters (k,) whose twins are fitted as the recording was, and the standard deviations of such
    fits.

    Indirect inference (Gourieroux, Monfort, Renault 1993): the error of a likelihood that is not exact, and
    of light that frames do not fix, is what the same fit makes of twins. The second time it is where the
    first led.
    """
    truth, made = fitted.log, 0
    fits = np.zeros((0, len(truth)))
    for twins in TWINS:
        truth = possible(truth)
        values, parts = named(truth), []
        parameters = likelihood_parameters(values, dead_us, delay_us)
        for _ in range(twins // PER_LIGHT):
            retaken = retake(reading.scene, np.random.default_rng(seed + made + 1), values["bend_error"])
            for _ in range(PER_LIGHT):
                made += 1
                report(f"twin {made} of {sum(TWINS)}")
                own = replace(reading, events=twin(retaken, parameters, seed + made), scene=retaken.scene)
                seen, waited = own.intervals(dead_us, delay_us), own.waits()
                parts.append(maximise(seen, dead_us, truth, em_steps=1, waits=waited)[0])
        fits = np.array(parts)
        truth = _corrected(truth, fitted, fits)
    return truth, np.asarray(fits.std(axis=0, ddof=1) * np.sqrt(1 + 1 / len(fits)))


def _corrected(truth: Vector, fitted: Fit, fits: NDArray[np.float64]) -> Vector:
    """Log parameters whose twins fit as the recording did, from twins of `truth` that fit as `fits` (n, k).

    Nothing moves in directions that the data do not fix. Spreads add up in squares: one that is all error of
    the fit goes to nothing.
    """
    corrected: Vector = truth - fitted.informed @ np.clip(fits.mean(axis=0) - fitted.log, -1, 1)
    for i, name in enumerate(NAMES):
        if name.endswith("_spread"):
            square = np.exp(2 * truth[i]) - np.exp(2 * fits[:, i]).mean() + np.exp(2 * fitted.log[i])
            corrected[i] = 0.5 * np.log(max(square, LEAST_SPREAD**2))
    return corrected


@dataclass(frozen=True, eq=False)
class Retaken:
    """Light like that of a recording, and the scene of frames taken of it at other moments.

    What is between the frames, and between two grey levels, is then known: to the twin, not to the fit.
    """

    light: list[tuple[NDArray[np.float32], int]]
    scene: Scene


def retake(scene: Scene, rng: np.random.Generator, bend_error: float) -> Retaken:
    """Light moved by a part of the frame period and a part of a grey level, with new frames at the same times
    and new light between these. bend_error: how far it is off between the first frames, times `Scene.doubt`,
    normally.
    """
    whole = np.issubdtype(scene.taken.dtype, np.integer)
    shape = (scene.height, scene.width)
    levels, alike = np.unique(scene.taken[0], return_inverse=True)  # light that is alike is rounded alike
    shift = (rng.random(levels.size, np.float32) - np.float32(0.5))[alike].reshape(shape) * np.float32(whole)
    later_us = round(rng.uniform(0.25, 0.75) * float(np.median(np.diff(scene.taken_us))))
    light = [
        (np.maximum(image + shift, 0), t_us - later_us)
        for image, t_us in with_wandering_light(scene, rng, bend_error)
    ]
    t_us = np.array([t for _, t in light])
    taken_us = scene.taken_us[scene.taken_us <= t_us[-1]]
    frames = np.empty((len(taken_us), *shape), np.float32)
    for k, after in enumerate(np.clip(np.searchsorted(t_us, taken_us), 1, len(t_us) - 1)):
        (before, begin), (image, end) = light[after - 1], light[after]
        frames[k] = before + (image - before) * np.float32((taken_us[k] - begin) / (end - begin))
    rounded = np.clip(np.rint(frames), 0, 255).astype(scene.taken.dtype) if whole else frames
    return Retaken(light, scene_of(rounded, taken_us, scene.how))


def with_wandering_light(
    scene: Scene, rng: np.random.Generator, bend_error: float
) -> Iterator[tuple[NDArray[np.float32], int]]:
    """The images and times of a scene, off between frames as its `doubt` has it."""
    pixel, gap = np.arange(scene.width * scene.height, dtype=np.int32), -1
    error = np.zeros((scene.height, scene.width), np.float32)
    for image, t_us in zip(scene.images, scene.t_us.tolist(), strict=True):
        here = int(np.searchsorted(scene.taken_us, t_us))
        if here != gap:
            gap, error = here, np.float32(bend_error) * rng.standard_normal(error.shape, np.float32)
        doubt = scene.doubt(pixel, np.full(pixel.size, float(t_us))).reshape(error.shape)
        yield image + error * doubt.astype(np.float32), t_us


def twin(retaken: Retaken, parameters: Parameters, seed: int) -> NDArray[np.void]:
    """Events (EVENT) of the model that sees the light."""
    simulator = Simulator(retaken.scene.width, retaken.scene.height, parameters, seed=seed)
    events = simulator.advance_along(retaken.light)
    later: NDArray[np.void] = events[events["t"] >= retaken.scene.t_us[0]]
    return later
