"""Kernels compiled beforehand: once for each kind, at little cost."""

import gc
import resource
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from numba.core.dispatcher import Dispatcher
from tests.campaigns.legal import Legal

from voltcam_server import compiling
from voltcam_server.compiling import CompiledEffects
from voltcam_server.simulation import Simulation
from voltcam_simulator import GivenUpError, Limits, Parameters, Simulator

from .rig import tiny
from .test_overload import TOO_MANY


def test_what_is_compiled_beforehand_needs_little() -> None:
    """The limits of all rates at once: 20 s and 2.2 GB, once."""
    simulation = Simulation(tiny(), "exact", 0)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for changes in TOO_MANY:
        simulation.prepare(Parameters().changed(changes))
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000  # KiB


@pytest.fixture
def tried(monkeypatch: pytest.MonkeyPatch) -> list[Parameters]:
    """The parameters that a small sensor was tried with."""
    tried: list[Parameters] = []

    def simulator(width: int, height: int, parameters: Parameters, law: Any, device: Any) -> Simulator:
        assert (law, device) == ("exact", "cpu")
        tried.append(parameters)
        return Simulator(width, height, parameters, law)

    monkeypatch.setattr(compiling, "Simulator", simulator)
    return tried


def test_what_has_been_compiled_is_not_tried_again(tried: list[Parameters]) -> None:
    compiled, parameters = CompiledEffects("exact"), Parameters()
    first = 1 + len(compiling.THETAS)
    for changes in ({}, {"comparator": {"theta_on": 2}}, {"leak_noise": {"k6": 2e-7}}):
        compiled.prepare(parameters.changed(changes))
    assert len(tried) == first
    compiled.prepare(parameters.changed({"reset_noise": {"sigma": 0.1}}))
    assert len(tried) == first + 1
    compiled.prepare(parameters.changed({"contrast_response": {"response": "linearised"}}))
    assert len(tried) == first + 2  # another way of one effect is another kernel
    compiled.prepare(parameters)
    assert len(tried) == first + 3  # what is off decides, too, what the kernels of others are given
    CompiledEffects("exact").prepare(parameters)
    assert len(tried) == 2 * first + 3


def kernels() -> list[Dispatcher]:
    """All of the simulator that there are now. Objects of some libraries warn if asked for their class."""
    return [found for found in gc.get_objects() if issubclass(type(found), Dispatcher)]


def test_no_frame_waits_for_a_kernel_whatever_is_changed() -> None:
    """Anything of the whole legal range, on top of each other, put back now and then."""
    legal, base = Legal(Parameters.model_json_schema(), seed=31), Parameters.of("typical")
    compiled, parameters = CompiledEffects("exact"), base
    compiled.prepare(base)
    all_kernels = kernels()
    for i in range(150):
        parameters = base if i % 30 == 0 else parameters.changed(legal.change())
        compiled.prepare(parameters)
        before = [len(kernel.overloads) for kernel in all_kernels]
        camera = Simulator(16, 12, parameters)
        limits = Limits(max(1.0, 16_667 / parameters.longest_step_us / 16), 200_000)
        for k, dtype in enumerate((np.uint8, np.float32, np.uint8)):
            image = np.full((12, 16), 200 if k == 1 else 20, dtype)
            with suppress(GivenUpError):
                camera.advance(image, 16_667 * k, limits)
        missed = [k.__name__ for k, n in zip(all_kernels, before, strict=True) if len(k.overloads) > n]
        assert not missed, f"{missed} were not compiled before change {i}"


def test_an_interval_of_too_many_events_is_tried_shorter(
    tried: list[Parameters], monkeypatch: pytest.MonkeyPatch
) -> None:
    """White in a step at the smallest thresholds: 10 500 events for each of the four pixels."""
    hard = Parameters().changed({"comparator": {"theta_on": 0.001, "theta_off": 0.001}})
    CompiledEffects("exact").prepare(hard)
    assert len(tried) == len(compiling.THETAS) + len(compiling.SPANS_US)
