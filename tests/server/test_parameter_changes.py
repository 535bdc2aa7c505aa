"""Parameters that change while a camera runs: asked for at any time, taken on between two intervals."""

import threading

import numpy as np
import pytest
from pydantic import ValidationError

from voltcam_server.parameter_changes import ParameterChanges
from voltcam_server.simulation import Simulation
from voltcam_simulator import Parameters, Simulator

from .rig import arrival, tiny, until


def test_parameters_of_a_moving_slider_are_laid_down_once(monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = Simulation(tiny(), "exact", 0)
    laid, go, made = simulation._simulator.laid_down, threading.Event(), []

    def slow(parameters: Parameters) -> object:
        go.wait(20)
        made.append(parameters.temperature_c)
        return laid(parameters)

    monkeypatch.setattr(simulation._simulator, "laid_down", slow)
    turns = [
        threading.Thread(target=simulation.change, args=({"temperature_c": 20.0 + i},)) for i in range(20)
    ]
    for turn in turns:
        turn.start()
    until(lambda: simulation.parameters[1] == 20, "all are known")
    go.set()
    for turn in turns:
        turn.join(20)
    assert len(made) <= 2
    simulation.step(arrival(np.zeros((16, 24), np.uint8), 0))
    interval = simulation.step(arrival(np.zeros((16, 24), np.uint8), 1000))
    assert interval is not None
    assert interval.parameters_version == 20


@pytest.fixture
def changes() -> ParameterChanges:
    return ParameterChanges(Simulator(4, 3))


def test_a_change_is_known_at_once_and_holds_when_it_is_taken(changes: ParameterChanges) -> None:
    simulator = changes._simulator
    first = simulator.parameters
    assert changes.newest == (first, 0)
    wanted = changes.change({"temperature_c": 40})
    assert wanted == changes.newest == (first.changed({"temperature_c": 40}), 1)
    assert (simulator.parameters, changes.version) == (first, 0)
    changes.take()
    assert (simulator.parameters, changes.version) == (wanted[0], 1)
    changes.take()
    assert changes.version == 1


def test_changes_between_two_intervals_add_up_and_the_newest_is_taken(changes: ParameterChanges) -> None:
    changes.change({"temperature_c": 40})
    changes.change({"comparator": {"theta_on": 2}})
    changes.take()
    now = changes._simulator.parameters
    assert (changes.version, now.temperature_c, now.comparator.theta_on) == (2, 40, 2)


def test_one_that_cannot_be_changes_nothing(changes: ParameterChanges) -> None:
    before = changes.newest
    with pytest.raises(ValidationError, match="theta_on"):
        changes.change({"temperature_c": 40, "comparator": {"theta_on": -1}})
    assert changes.newest == before
    changes.take()
    assert changes.version == 0
