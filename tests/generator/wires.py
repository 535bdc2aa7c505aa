"""The pixels of one recording while effects are being put into them, and the run through them."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .base import Base
from .kernel import PER_DN, TABLE, run
from .pixels import Maps, Numbers, State, Tables
from .scene import Scene

Floats = NDArray[np.float64]
WARM_UP_US = 500_000.0  # before time 0, in the moving scene, so that voltages have their stationary spread


def radiances() -> Floats:
    """Of the kernel's tables, in DN."""
    return np.arange(TABLE) / PER_DN


@dataclass
class Wires:
    """Tables over radiance and maps over pixels by the kernel's names, numbers for all, factors by step."""

    numbers: Numbers
    tables: Tables
    maps: Maps
    light: Floats  # per step, factors
    junction: Floats
    theta: Floats
    t_us: Floats  # of the steps' ends
    end_us: float
    frame_t_us: NDArray[np.int64]
    kick_us: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    patterns: dict[str, Any] = field(default_factory=dict)  # for the record's truth
    fixed: np.random.Generator | None = None  # of patterns that are drawn at the readout; None: as its noise

    @property
    def shape(self) -> tuple[int, int]:
        height, width = self.maps.theta_on.shape
        return height, width

    def set(self, **numbers: float) -> None:
        self.numbers = self.numbers._replace(**{name: float(value) for name, value in numbers.items()})


def plain(base: Base, scene: Scene, seconds: float, step_us: float, frame_t_us: NDArray[np.int64]) -> Wires:
    """The base model and nothing else."""
    light, ones = radiances(), np.ones((scene.height, scene.width))
    tables = Tables(base.leak(light), base.sigma(light), np.zeros_like(light), np.zeros_like(light))
    maps = Maps(base.theta_on * ones, base.theta_off * ones, base.k4 * ones, 0 * ones)
    steps = math.ceil((WARM_UP_US + seconds * 1e6) / step_us)
    t_us = np.asarray(step_us * np.arange(1, steps + 1) - WARM_UP_US, float)
    factors = (np.ones(steps), np.ones(steps), np.ones(steps))
    numbers = Numbers(float(base.k1), float(base.k2))
    return Wires(numbers, tables, maps, *factors, t_us, seconds * 1e6, frame_t_us)


def _towards(wires: Wires, light: Floats) -> Floats:
    """The threshold, signed, that each pixel drifts to at rest: its voltage is anywhere between 0 and it."""
    rate = np.interp(light, radiances(), wires.tables.leak_per_us)
    rate += wires.maps.junction_per_us + wires.maps.drift_per_us
    return np.where(rate >= 0, wires.maps.theta_on, -wires.maps.theta_off)


def events_of(wires: Wires, scene: Scene, step_us: float, rng: np.random.Generator) -> Floats:
    """(events, 4): t [us], x, y, sign, sorted by time, from time 0 on."""
    first = scene.radiance(np.array([-WARM_UP_US]))[0] * wires.light[0]
    state = State(*(np.zeros(wires.shape) for _ in State._fields))
    state.v[:] = rng.uniform(0, 1, wires.shape) * _towards(wires, first)
    state.dead_us[:] = -np.inf
    state.light[:] = first
    for log in (state.log, state.slow, state.slower):
        log[:] = np.log(first + wires.numbers.k2)
    factors = np.column_stack([wires.light, wires.junction, wires.theta])
    events = run(
        -WARM_UP_US, float(step_us), scene.poses(wires.t_us), scene.canvas, factors, wires.kick_us,
        wires.numbers, wires.tables, wires.maps, state, rng,
    )  # fmt: skip
    events = events[(events[:, 0] >= 0) & (events[:, 0] < wires.end_us)]
    return np.asarray(events[np.argsort(events[:, 0], kind="stable")])
