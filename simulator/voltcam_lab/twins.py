"""Twins: recordings the model makes of the same scene, where the truth is known."""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import EVENT, Parameters, Simulator

from .estimates import parameters_of
from .fit import maximise, named
from .likelihood import NAMES
from .reading import Reading
from .scene import Scene

TWINS, TURNS = 8, 2
LEAST_SPREAD = 1e-4  # thresholds: nothing
Vector = NDArray[np.float64]


def unbiased(
    reading: Reading, found: Vector, dead_us: float, delay_us: float, seed: int, report: Callable[[str], None]
) -> tuple[Vector, Vector]:
    """Log parameters (k,) whose twins fit as the recording did, and the standard deviations of such fits.

    Indirect inference (Gourieroux, Monfort, Renault 1993): the error of a likelihood that is not exact, and of
    light that frames do not fix, is what the same fit makes of twins. Twice, the second time where the first led.
    """
    truth, squares = found, np.zeros(len(found))
    for turn in range(TURNS):
        values, fits = named(truth), []
        parameters = parameters_of(values, dead_us, delay_us)
        for n in range(turn * TWINS, (turn + 1) * TWINS):
            report(f"twin {n + 1} of {TURNS * TWINS}")
            events = twin(reading.scene, parameters, seed + n + 1, values["bend_error"])
            own = replace(reading, events=events)
            seen, waited = own.intervals(dead_us, delay_us), own.waits()
            fits.append(maximise(seen, dead_us, truth, em_steps=2, waits=waited)[0])
        truth = _corrected(truth, found, np.array(fits))
        squares += np.var(fits, axis=0, ddof=1) / TURNS
    return truth, np.sqrt(squares * (1 + 1 / TWINS))


def _corrected(truth: Vector, found: Vector, fits: NDArray[np.float64]) -> Vector:
    """Log parameters whose twins fit as `found`, from twins of `truth` that fit as `fits` (n, k).

    Spreads add up in squares: one that is all error of the fit goes to nothing.
    """
    shift = np.clip(fits.mean(axis=0) - found, -1, 1)
    corrected = truth - shift
    for i, name in enumerate(NAMES):
        if name.endswith("_spread"):
            square = np.exp(2 * truth[i]) - np.exp(2 * fits[:, i]).mean() + np.exp(2 * found[i])
            corrected[i] = 0.5 * np.log(max(square, LEAST_SPREAD**2))
    return corrected


def twin(scene: Scene, parameters: Parameters, seed: int, bend_error: float = 0.0) -> NDArray[np.void]:
    """Events (EVENT) of the model on light that the frames may have shown.

    The frames do not fix the light: it is drawn anew from what they leave open (`light_behind`).
    """
    simulator = Simulator(scene.width, scene.height, parameters, seed=seed)
    found = [
        simulator.advance(image, t_us)
        for image, t_us in light_behind(scene, np.random.default_rng(seed), bend_error)
    ]
    return np.concatenate([np.empty(0, EVENT), *found])


def light_behind(
    scene: Scene, rng: np.random.Generator, bend_error: float
) -> Iterator[tuple[NDArray[np.float32], int]]:
    """Light that the frames may have been taken of: (H, W) float32 [DN] and its time [us].

    Whole grey levels are roundings: each stands for any light within half a level, the same as long as it does
    not change. Between frames the light is off by `bend_error` times `Scene.doubt`, normally.
    """
    shape = (scene.height, scene.width)
    whole = np.issubdtype(scene.taken.dtype, np.integer)

    def rounded_off(frame: int, former: NDArray[np.float32] | None) -> NDArray[np.float32]:
        if not whole:
            return np.zeros(shape, np.float32)
        anew = rng.random(shape, np.float32) - np.float32(0.5)
        return (
            anew if former is None else np.where(scene.taken[frame] == scene.taken[frame - 1], former, anew)
        )

    pixel, frame = np.arange(shape[0] * shape[1], dtype=np.int32), 0
    now = rounded_off(0, None)
    later, gap = rounded_off(1, now), rng.standard_normal(shape, np.float32)
    for image, t_us in zip(scene.images, scene.t_us.tolist(), strict=True):
        while frame < len(scene.taken_us) - 2 and t_us > scene.taken_us[frame + 1]:
            frame += 1
            now, later = later, rounded_off(frame + 1, later)
            gap = rng.standard_normal(shape, np.float32)
        span_us = scene.taken_us[frame + 1] - scene.taken_us[frame]
        phase = np.float32(min(max((t_us - scene.taken_us[frame]) / span_us, 0.0), 1.0))
        light = image + (1 - phase) * now + phase * later
        if bend_error > 0:
            light += bend_error * gap * scene.doubt(pixel, np.full(pixel.size, float(t_us))).reshape(shape)
        yield np.maximum(light, 0).astype(np.float32), t_us
