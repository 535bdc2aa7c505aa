"""Models of the pixel under one interface: ours by both laws, and the baselines."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from voltcam_simulator import EVENT, Parameters, Simulator
from voltcam_simulator.effect import Events

from ..light.scene import Scene
from .esim import Esim, EsimParameters
from .v2e import V2e, V2eParameters

AnyParameters = Parameters | EsimParameters | V2eParameters


class Model(Protocol):
    """A sensor that is shown images, one after another."""

    def advance(self, image: ArrayLike, t_us: int, /) -> Events:
        """The events between the last image (height, width) [DN] and this one, sorted by time."""
        ...


Maker = Callable[[int, int, Any, int], Model]
"""(width, height, parameters of that model or None for its published ones, seed) -> Model."""


def _exact(width: int, height: int, parameters: Parameters | None, seed: int) -> Model:
    return Simulator(width, height, parameters or Parameters.of("typical"), "exact", seed)


def _paper(width: int, height: int, parameters: Parameters | None, seed: int) -> Model:
    return Simulator(width, height, parameters or Parameters.of("paper"), "paper", seed)


MODELS: dict[str, Maker] = {"exact": _exact, "paper": _paper, "esim": Esim, "v2e": V2e}

PUBLISHED: dict[str, Callable[[], AnyParameters]] = {
    "exact": lambda: Parameters.of("typical"),
    "paper": lambda: Parameters.of("paper"),
    "esim": EsimParameters,
    "v2e": V2eParameters,
}
"""The parameters that a maker takes for None."""


def simulate(model: Model, scene: Scene) -> Events:
    """All events of a scene, sorted by time."""
    parts = [model.advance(frame.image, frame.t_us) for frame in scene.frames()]
    return np.concatenate([np.empty(0, EVENT), *parts])


def with_thresholds(parameters: AnyParameters, theta_on: float, theta_off: float) -> AnyParameters:
    """A copy with other thresholds, in the model's own unit."""
    if isinstance(parameters, (EsimParameters, V2eParameters)):
        return replace(parameters, theta_on=theta_on, theta_off=theta_off)
    return parameters.changed({"comparator": {"theta_on": theta_on, "theta_off": theta_off}})


def with_fitted_thresholds(
    name: str,
    scene: Scene,
    wanted_on: int,
    wanted_off: int,
    parameters: AnyParameters | None = None,
    seed: int = 0,
    counted: Callable[[Events], Events] = lambda events: events,
) -> AnyParameters:
    """Parameters of a model of MODELS with thresholds by `fit_thresholds`, whose arguments the rest are."""
    base = parameters if parameters is not None else PUBLISHED[name]()

    def model(theta_on: float, theta_off: float) -> Model:
        return MODELS[name](scene.width, scene.height, with_thresholds(base, theta_on, theta_off), seed)

    start = 1.0 if isinstance(base, Parameters) else 0.3  # in ln units, typical of cameras
    return with_thresholds(base, *fit_thresholds(model, scene, wanted_on, wanted_off, start, counted))


SIMULATIONS, TOLERANCE = 16, 0.01
LOG_LIMITS = math.log(0.011), math.log(100.0)  # of thresholds: the baselines' clip, the end of `comparator`


def fit_thresholds(
    make: Callable[[float, float], Model],
    scene: Scene,
    wanted_on: int,
    wanted_off: int,
    start: float,
    counted: Callable[[Events], Events] = lambda events: events,
) -> tuple[float, float]:
    """(theta_on, theta_off) with which a model gives out as many events of each polarity as wanted, to 1 %;
    the nearest seen in 16 simulations where that is not reached.

    make: (theta_on, theta_off) -> Model. start: where both begin. counted: which of the simulated events
    count, where some of the recording's own were left out.

    Broyden's method on the logarithms, since the counts fall with about a power of each threshold.
    """
    x = np.full(2, math.log(start))
    wanted = np.log(np.array([wanted_on, wanted_off]) + 0.5)
    slopes = -np.eye(2)
    best, best_miss = x, math.inf
    former: tuple[NDArray[Any], NDArray[Any]] | None = None
    for _ in range(SIMULATIONS):
        events = counted(simulate(make(*np.exp(x).tolist()), scene))
        on = np.count_nonzero(events["p"])
        miss = np.log(np.array([on, len(events) - on]) + 0.5) - wanted
        if np.abs(miss).max() < best_miss:
            best, best_miss = x, float(np.abs(miss).max())
        if best_miss < TOLERANCE:
            break
        if former is not None:
            way = x - former[0]
            slopes += np.outer(miss - former[1] - slopes @ way, way) / max(float(way @ way), 1e-12)
        if slopes[0, 0] > -0.2 or slopes[1, 1] > -0.2 or np.linalg.det(slopes) < 0.05:
            slopes = -np.eye(2)  # the counts of few events go in steps, which misled it
        former = (x, miss)
        x = np.clip(x - np.clip(np.linalg.solve(slopes, miss), -1.0, 1.0), *LOG_LIMITS)
    theta_on, theta_off = np.exp(best).tolist()
    return theta_on, theta_off
