"""Events through the stages behind the pixels: who waits, who leaves, and what is complete."""

import numpy as np
import pytest

from voltcam_simulator import EVENT, Limits, Parameters
from voltcam_simulator.effect import Events
from voltcam_simulator.event_stages import EventStages
from voltcam_simulator.limits import TooManyEventsError
from voltcam_simulator.pixel_array import PixelArray

from .scenes import only

LIGHT = np.zeros(4, np.float32)


def stages_of(parameters: Parameters, t_us: int = 0) -> tuple[EventStages, PixelArray]:
    pixels = PixelArray(4, 1, "exact", 1, 1)
    stages = EventStages(pixels)
    configure(stages, pixels, parameters)
    stages.restart(t_us, goes_on=False)
    return stages, pixels


def configure(stages: EventStages, pixels: PixelArray, parameters: Parameters) -> None:
    pixels.configure(pixels.laid_down(parameters))
    stages.configure(parameters)


def events_at(*t_us: int) -> Events:
    events = np.zeros(len(t_us), EVENT)
    events["t"], events["x"] = t_us, np.arange(len(t_us)) % 4
    return events


def test_without_effects_events_pass_untouched() -> None:
    stages, _ = stages_of(only())
    events = events_at(3, 900)
    assert stages.passed(events, 0, 1000, 0, LIGHT, Limits()) is events
    assert stages.read_us == stages.complete_us == 1000


def test_a_delayed_event_waits_for_the_interval_in_which_it_is_due() -> None:
    stages, _ = stages_of(only(latency={"delay_us": 700}))
    first = stages.passed(events_at(100, 600), 0, 1000, 0, LIGHT, Limits())
    assert first["t"].tolist() == [800]
    assert stages.waiting["latency"]["t"].tolist() == [1300]
    second = stages.passed(events_at(1100), 1000, 2000, 1, LIGHT, Limits())
    assert second["t"].tolist() == [1300, 1800]
    assert not stages.waiting


def test_what_is_exactly_due_at_the_end_leaves() -> None:
    stages, _ = stages_of(only(latency={"delay_us": 700}))
    assert stages.passed(events_at(300, 301), 0, 1000, 0, LIGHT, Limits())["t"].tolist() == [1000]


def test_what_waits_leaves_after_its_effect_is_switched_off() -> None:
    stages, pixels = stages_of(only(latency={"delay_us": 1500}))
    assert stages.passed(events_at(100), 0, 1000, 0, LIGHT, Limits()).size == 0
    configure(stages, pixels, only())
    assert stages.passed(events_at(1050), 1000, 2000, 1, LIGHT, Limits())["t"].tolist() == [1050, 1600]
    assert not stages.waiting


def test_an_effect_that_stamps_earlier_holds_the_stream_back_by_as_much() -> None:
    """At 1000 us events to come may be stamped 300 us earlier: complete is what is before 700 us."""
    stages, _ = stages_of(only(latency={"delay_us": -300}))
    assert stages.passed(events_at(400, 900, 1000), 0, 1000, 0, LIGHT, Limits())["t"].tolist() == [
        100,
        600,
        700,
    ]
    assert stages.read_us == stages.complete_us == 700
    assert stages.passed(events_at(1001, 1200), 1000, 2000, 1, LIGHT, Limits())["t"].tolist() == [701, 900]
    assert stages.complete_us == 1700


def test_complete_is_the_last_tick_of_a_coarse_clock() -> None:
    stages, _ = stages_of(only(timestamp_quantum={"quantum_us": 300}))
    assert stages.passed(events_at(1, 599, 950), 0, 1000, 0, LIGHT, Limits())["t"].tolist() == [0, 300, 900]
    assert (stages.read_us, stages.complete_us) == (1000, 900)


def test_a_clock_that_has_just_become_coarser_stamps_nothing_before_what_has_left() -> None:
    stages, pixels = stages_of(only(timestamp_quantum={"quantum_us": 10}))
    stages.passed(events_at(955), 0, 960, 0, LIGHT, Limits())
    configure(stages, pixels, only(timestamp_quantum={"quantum_us": 500}))
    assert stages.passed(events_at(970, 1100), 960, 1200, 1, LIGHT, Limits())["t"].tolist() == [960, 1000]


@pytest.mark.parametrize(("goes_on", "complete_us"), [(True, 1000), (False, 900)])
def test_a_restart_forgets_what_is_on_its_way(goes_on: bool, complete_us: int) -> None:
    stages, pixels = stages_of(only(latency={"delay_us": 700}))
    stages.passed(events_at(900), 0, 1000, 0, LIGHT, Limits())
    configure(stages, pixels, only(timestamp_quantum={"quantum_us": 300}))
    stages.restart(1100, goes_on)
    assert not stages.waiting
    assert (stages.read_us, stages.complete_us) == (1100, complete_us)


def test_stages_follow_the_order_of_the_registry() -> None:
    """A delay of 250 us, then the tick of 100 us: not the other way round."""
    stages, _ = stages_of(only(timestamp_quantum={"quantum_us": 100}, latency={"delay_us": 250}))
    assert stages.passed(events_at(199), 0, 1000, 0, LIGHT, Limits())["t"].tolist() == [400]


def test_what_waits_counts_for_the_limit() -> None:
    stages, _ = stages_of(only(latency={"delay_us": 5000}))
    limits = Limits(most_events=5)
    stages.passed(events_at(*range(3)), 0, 1000, 0, LIGHT, limits)
    with pytest.raises(TooManyEventsError):
        stages.passed(events_at(1000, 1001, 1002), 1000, 2000, 1, LIGHT, limits)


def test_only_an_effect_that_changes_voltages_feeds_back() -> None:
    assert not stages_of(Parameters.of("typical"))[0].feed_back
    assert stages_of(only(crosstalk={"coupling": 0.01}))[0].feed_back
