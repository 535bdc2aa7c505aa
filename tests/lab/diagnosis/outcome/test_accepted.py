"""Which camera file is given: the one by which all events are differ least."""

import pytest

from voltcam_lab.diagnosis.outcome.accepted import Accepted, accepted, fitted
from voltcam_lab.diagnosis.rig.whole import WholeSensor
from voltcam_simulator import Parameters

from ..conftest import Done

TRIPLED = {"contrast_response": {"k1": 14.0}}  # of the published set: 5.265


def chosen(sensor: WholeSensor, given: Parameters, fitted: Parameters, named: bool = True) -> Accepted:
    said: list[str] = []
    choice = accepted(sensor, given, fitted, named, said.append)
    assert len(said) == 1
    return choice


def test_what_was_found_is_nearer_than_the_file_that_lacks_it(done: Done) -> None:
    """A dead time of 6 ms, which the given file has not."""
    found = fitted(done.diagnosis)
    choice = chosen(done.session.sensor, done.session.parameters, found)
    assert choice.way != "as it was"
    assert choice.difference[choice.way] < choice.difference["as it was"] / 2
    assert choice.parameters.refractory_period == found.refractory_period
    assert f"{choice.difference['as it was']:.2f} with the camera file as it was" in choice.sentence()
    assert choice.record().way == choice.way
    assert choice.record().difference == choice.difference


def test_base_parameters_that_only_fit_the_known_light_are_not_taken(done: Done) -> None:
    found, given = fitted(done.diagnosis), done.session.parameters
    choice = chosen(done.session.sensor, given, found.changed(TRIPLED))
    assert choice.way == "found added"
    assert choice.parameters.contrast_response == given.contrast_response
    assert choice.parameters.refractory_period == found.refractory_period
    assert choice.sentence().endswith("the one that was given, with what was found added.")


def test_what_was_taken_out_comes_back_where_all_pixels_want_it(done: Done) -> None:
    """The recording has a dead time and no delay; what was fitted has lost the dead time and has a delay."""
    given = fitted(done.diagnosis)
    lost = given.changed({"refractory_period": {"period_us": 0}, "latency": {"delay_us": 100}})
    choice = chosen(done.session.sensor, given, lost)
    assert choice.way != "fitted"
    assert choice.parameters.refractory_period == given.refractory_period
    assert set(choice.difference) == {"fitted", "found added", "as it was"}
    assert chosen(done.session.sensor, lost, given).way == "fitted"


def test_a_file_that_is_nearest_stays_as_it_was(done: Done) -> None:
    given = fitted(done.diagnosis)
    choice = chosen(done.session.sensor, given, given.changed(TRIPLED))
    assert list(choice.difference) == ["fitted", "as it was"]
    assert choice.parameters == given
    assert choice.sentence().endswith("the new file is the one that was given.")


def test_where_nothing_changed_there_is_one_way(done: Done) -> None:
    given = done.session.parameters
    assert list(chosen(done.session.sensor, given, given).difference) == ["fitted"]


@pytest.mark.parametrize("named", [True, False])
def test_a_change_that_makes_no_difference_is_taken_with_a_name_only(done: Done, named: bool) -> None:
    given = fitted(done.diagnosis)
    hardly = given.changed({"reset_noise": {"sigma": 1e-5}})
    choice = chosen(done.session.sensor, given, hardly, named)
    assert choice.difference["fitted"] == pytest.approx(choice.difference["as it was"], rel=0.2)
    assert choice.way == ("fitted" if named else "as it was")


def test_a_name_is_kept_where_only_the_base_parameters_make_it_worse(done: Done) -> None:
    """The file is as near with what was found as without, and what was fitted is far from both."""
    given = fitted(done.diagnosis)
    found = given.changed({**TRIPLED, "reset_noise": {"sigma": 1e-5}})
    assert chosen(done.session.sensor, given, found).way == "found added"


class LateAndPushed:
    """Stands for a sensor whose recording is nearest to cameras that are late and pushed by frames."""

    def difference(self, parameters: Parameters, run: int) -> float:
        return float(not parameters.latency.active) + float(not parameters.aps_coupling.active) + 0.01 * run


def test_a_push_found_without_a_delay_acts_sooner_with_it() -> None:
    """Its events are where they were stamped: 2 ms before the delay of 2 ms is over."""
    pushed = {"frame_period_us": 40_000, "offset_us": 1_000, "readout_kick": 0.1}
    given = Parameters().changed({"latency": {"delay_us": 2_000}})
    choice = chosen(LateAndPushed(), given, Parameters().changed({"aps_coupling": pushed}))  # type: ignore[arg-type]
    assert choice.way == "found added"
    assert choice.parameters.latency == given.latency
    assert choice.parameters.aps_coupling.offset_us == 39_000
    assert choice.parameters.aps_coupling.readout_kick == 0.1


@pytest.mark.parametrize("way", ["fitted", "as it was"])
def test_a_sentence_has_each_way_and_what_was_chosen(way: str) -> None:
    choice = Accepted(Parameters(), way, {"fitted": 0.312, "as it was": 0.704})  # type: ignore[arg-type]
    assert "It is 0.31 with what was fitted. It is 0.70 with the camera file as it was." in choice.sentence()
