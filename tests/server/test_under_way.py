"""Intervals whose events are reported while the pixels of the next frame are drawn: nothing else changes."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from voltcam_server import simulation as module
from voltcam_server.interval import Interval
from voltcam_server.mailbox import Arrival
from voltcam_server.overload import OverloadSettings
from voltcam_server.simulation import Simulation
from voltcam_simulator import EVENT

from .rig import PATIENCE_S, arrival, moving_frames, tiny

Given = list[Interval | None]
PATIENT = OverloadSettings(longest_work_s=PATIENCE_S)  # kernels may have to be compiled
EFFECTS = {
    "latency": {"delay_us": 900, "jitter_us": 300},
    "readout": {"row_us": 2, "event_us": 1},
    "noise_pairs": {"rate_hz": 30},
    "refractory_period": {"period_us": 500},
}


@pytest.fixture(params=[1, 2], ids=["one thread", "two threads"])
def _threads(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "threads_for", lambda *_, **__: request.param)


def eventful() -> list[Arrival]:
    """Forty frames with all that may come between two of them."""
    came = [arrival(image, 10_000 * i) for i, image in enumerate(moving_frames(40, tiny()))]
    came[8] = arrival(came[8].frame.image, 60_000)  # not after the one before
    came[12] = replace(came[12], cut=True)
    came[15] = arrival(np.full((16, 24), np.nan, np.float32), 150_000)
    came[19] = replace(came[19], missed=1)
    came[24] = replace(came[24], frame=replace(came[24].frame, gamma=2.2))
    replayed = np.zeros(3, EVENT)
    replayed["t"] = 281_000
    came[28] = replace(came[28], frame=replace(came[28].frame, events=replayed))
    came[29] = replace(came[29], cut=True)
    later = [replace(one, frame=replace(one.frame, t_us=one.frame.t_us + 2_000_000)) for one in came[35:]]
    return came[:35] + later  # more than the longest interval


def told(given: Given) -> list[Any]:
    return [
        one
        and (one.start_us, one.end_us, one.frame_us, one.how, one.coarser, one.parameters_version, one.gamma)
        for one in given
    ]


@pytest.mark.usefixtures("_threads")
@pytest.mark.parametrize("upsample", ["off", "cubic", 2])
@pytest.mark.parametrize("changes", [{}, {"crosstalk": {"coupling": 0.05}}], ids=["", "fed back"])
def test_intervals_are_those_of_frame_by_frame(upsample: Any, changes: dict[str, Any]) -> None:
    camera = tiny(**EFFECTS, **changes)
    rng = np.random.default_rng(3)
    one_by_one, ahead = (Simulation(camera, "exact", 5, upsample, PATIENT) for _ in range(2))
    wanted: Given = []
    found: Given = []
    late = 0
    for i, came in enumerate(eventful()):
        if i == 21:
            for simulation in (one_by_one, ahead):
                simulation.change({"comparator": {"theta_on": 0.7}})
        wanted.append(one_by_one.step(came))
        waits = bool(rng.random() < 0.7) and i < 39
        ahead.follow(came, found.append, lambda waits=waits: waits)
        assert len(found) >= len(wanted) - waits
        late += len(found) < len(wanted)
    assert late > 10
    assert told(found) == told(wanted)
    for ours, theirs in zip(found, wanted, strict=True):
        if ours and theirs:
            np.testing.assert_array_equal(ours.events, theirs.events)
            np.testing.assert_array_equal(ours.image, theirs.image)
    assert sum(one.events.size for one in found if one) > 5000
    for name in ("simulated", "skipped", "skipped_us", "out_of_order", "unusable", "shift_us"):
        assert getattr(ahead, name) == getattr(one_by_one, name)


@pytest.mark.usefixtures("_threads")
def test_an_interval_is_given_before_the_next_is_drawn_and_not_held_up_by_it() -> None:
    """The first frame has no interval; the second's comes with the third, the last two's with the last."""
    simulation = Simulation(tiny(**EFFECTS), "exact", 5, overload=PATIENT)
    images = moving_frames(4, tiny())
    given: Given = []
    for i, count in enumerate((1, 1, 2, 4)):
        simulation.follow(arrival(images[i], 10_000 * i), given.append, lambda i=i: i < 3)
        assert len(given) == count


def test_who_looks_at_the_sensor_has_what_is_under_way_first() -> None:
    camera = tiny(**EFFECTS)
    one_by_one, ahead = (Simulation(camera, "exact", 5, overload=PATIENT) for _ in range(2))
    given: Given = []
    for i, image in enumerate(moving_frames(5, camera)):
        one_by_one.step(arrival(image, 10_000 * i))
        ahead.follow(arrival(image, 10_000 * i), given.append, lambda: True)
    assert len(given) == 4
    found, wanted = ahead.start_of("here"), one_by_one.start_of("here")
    assert len(given) == 5
    assert found.state.keys() == wanted.state.keys()
    for name, array in wanted.state.items():
        np.testing.assert_array_equal(found.state[name], array)
    ahead.finish()
    assert len(given) == 5


def test_a_source_may_go_from_recorded_events_to_frames() -> None:
    """The simulator has seen nothing of what was replayed: its first frame is the one after that."""
    simulation = Simulation(tiny(**EFFECTS), "exact", 5, overload=PATIENT)
    first, *others = (arrival(image, 10_000 * i) for i, image in enumerate(moving_frames(4, tiny())))
    given: Given = []
    for one in (replace(first, frame=replace(first.frame, events=np.empty(0, EVENT))), *others):
        simulation.follow(one, given.append, lambda: True)
    simulation.finish()
    assert [one and (one.how, one.events.size > 0) for one in given] == [
        ("replayed", False), ("advanced", False), ("advanced", True), ("advanced", True),
    ]  # fmt: skip


@pytest.mark.usefixtures("_threads")
def test_one_whose_events_are_too_many_takes_the_next_with_it() -> None:
    """Pairs are laid on the events behind the pixels: 76 800 in each of these intervals."""
    camera = tiny(**EFFECTS | {"latency": {"delay_us": 900, "jitter_us": 100}})
    overload = OverloadSettings(most_events=10_000, longest_work_s=PATIENCE_S)
    simulation = Simulation(camera, "exact", 5, overload=overload)
    images = moving_frames(6, camera)
    given: Given = []
    noisy = {"noise_pairs": {"rate_hz": 10_000, "half_dn": 1e5}}

    def follow(i: int, waits: bool) -> None:
        simulation.follow(arrival(images[i], 20_000 * i), given.append, lambda: waits)

    follow(0, False)
    simulation.change(noisy)
    follow(1, True)
    follow(2, True)
    assert [one and one.how for one in given] == ["jumped", "given up", "given up"]
    assert (simulation.skipped, simulation.skipped_us, simulation.simulated) == (2, 40_000, 1)
    assert "more than 10000 events" in simulation.load.trouble
    follow(3, False)
    assert given[-1] is not None
    assert given[-1].how == "given up"  # by itself, too
    simulation.change(camera.parameters.model_dump())
    follow(4, True)
    follow(5, False)
    assert [one and (one.how, one.start_us, one.end_us) for one in given[4:]] == [
        ("advanced", 60_000, 80_000), ("advanced", 80_000, 100_000),
    ]  # fmt: skip
    assert all(one.events.size > 0 for one in given[4:] if one)
