"""Kernels compiled beforehand: once for each kind, at little cost."""

import resource
from typing import Any

import pytest

from voltcam_server import compiling
from voltcam_server.compiling import CompiledEffects
from voltcam_server.simulation import Simulation
from voltcam_simulator import Parameters, Simulator

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
    for changes in ({}, {"comparator": {"theta_on": 2}}, {"leak_noise": {"k6": 0}}):
        compiled.prepare(parameters.changed(changes))
    assert len(tried) == 1
    compiled.prepare(parameters.changed({"reset_noise": {"sigma": 0.1}}))
    assert len(tried) == 2
    compiled.prepare(parameters.changed({"contrast_response": {"response": "linearised"}}))
    assert len(tried) == 3  # another way of one effect is another kernel
    CompiledEffects("exact").prepare(parameters)
    assert len(tried) == 4


def test_an_interval_of_too_many_events_is_tried_shorter(
    tried: list[Parameters], monkeypatch: pytest.MonkeyPatch
) -> None:
    """White in a step at the smallest thresholds: 10 500 events for each of the four pixels."""
    hard = Parameters().changed({"comparator": {"theta_on": 0.001, "theta_off": 0.001}})
    CompiledEffects("exact").prepare(hard)
    assert len(tried) == len(compiling.SPANS_US)
