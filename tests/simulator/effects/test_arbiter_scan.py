"""The token by its signature: a row leaves at its own phase of the round, together."""

import numpy as np
import pytest

from voltcam_simulator import Parameters, Simulator

from ..scenes import Events, only, still, watch_still

HEIGHT, WIDTH = 40, 20
ROUND_US = 250.0
NOISY = only(leak_noise={"k6": 3e-3})


def scanned(seconds: float = 2, busy: Parameters = NOISY, **scan: float) -> Events:
    return watch_still(
        Simulator(WIDTH, HEIGHT, busy.changed({"arbiter_scan": scan}), seed=3), 50, seconds, 100
    )


def phase_error(events: Events) -> np.ndarray:
    """How far from its row's pass each event is, in rounds."""
    phase = (events["t"] + 0.5) / ROUND_US - events["y"] / HEIGHT
    return np.abs(phase - np.round(phase))


def test_each_row_leaves_when_the_token_comes_by() -> None:
    storm = only(leak_noise={"k6": 2e-2})
    events = scanned(0.2, storm, round_us=ROUND_US)
    assert len(events) > 5000
    assert phase_error(events).max() <= 1 / ROUND_US  # stamps are whole microseconds
    same = (np.diff(events["t"]) == 0) & (np.diff(events["y"].astype(int)) == 0)
    assert same.mean() > 0.3


def test_an_event_waits_for_half_a_round_and_none_is_lost() -> None:
    free, waiting = scanned(round_us=0.0), scanned(round_us=ROUND_US)
    assert len(waiting) == pytest.approx(len(free), abs=30)  # some are still on their way
    late_us = waiting["t"].mean() - free["t"][: len(waiting)].mean()
    assert late_us == pytest.approx(ROUND_US / 2, abs=ROUND_US / 4)


def test_rows_may_be_passed_together() -> None:
    events = scanned(0.2, only(leak_noise={"k6": 2e-2}), round_us=ROUND_US, rows_together=4)
    events["y"] = events["y"] // 4 * 4
    assert phase_error(events).max() <= 1 / ROUND_US


STORM = only(leak_noise={"k6": 2e-2}, contrast_response={"k1": 2.0})
AT_ONCE = {"round_us": ROUND_US, "busy_per_us": 1e-6}  # rounds begin whenever they may


def scanned_by_ms(events: Events) -> np.ndarray:
    """(ms,) whether the token goes round; 1 in 60 events is on its pass by chance."""
    ms, on_pass = events["t"] // 1000, phase_error(events) <= 1 / ROUND_US
    return np.bincount(ms, on_pass) > 0.5 * np.bincount(ms)


def test_rounds_begin_once_in_10_ms_at_the_load_given() -> None:
    """Waits of 60 sensors are geometric: their mean has an sd of 1.3 ms, 4 are allowed. They begin
    in the fifth millisecond."""
    load = np.mean([len(watched(STORM, seed, 100)) / 1e5 for seed in range(3)])
    scan = {"round_us": ROUND_US, "busy_per_us": load, "steepness": 2.0}
    waits = [
        int(np.argmax(scanned_by_ms(watched(STORM.changed({"arbiter_scan": scan}), seed, 120))))
        for seed in range(60)
    ]
    assert np.mean(waits) == pytest.approx(4 + 9, abs=5.2)
    scan |= {"busy_per_us": 3 * load, "steepness": 20.0}
    assert not any(
        scanned_by_ms(watched(STORM.changed({"arbiter_scan": scan}), seed, 120)).any() for seed in range(5)
    )


def watched(parameters: Parameters, seed: int, ms: int) -> Events:
    return watch_still(Simulator(WIDTH, HEIGHT, parameters, seed=seed), 50, ms / 1000, 200)


@pytest.mark.parametrize("begin_us", [0, -500_000, 1_700_000_000_000_000])
@pytest.mark.parametrize(("burst_per_us", "ends"), [(1.0, True), (1000.0, False)])
def test_a_burst_ends_rounds_for_four_milliseconds(burst_per_us: float, ends: bool, begin_us: int) -> None:
    scan = AT_ONCE | {"burst_per_us": burst_per_us}
    simulator = Simulator(WIDTH, HEIGHT, STORM.changed({"arbiter_scan": scan}), seed=2)
    frames = [(50, 0), (50, 20_000), (250, 20_100), (250, 40_000)]
    events = np.concatenate([
        simulator.advance(still(grey, WIDTH, HEIGHT), begin_us + t) for grey, t in frames
    ])  # fmt: skip
    events["t"] -= begin_us
    going = scanned_by_ms(events)
    assert not going[:4].any()
    assert going[5:20].all()
    assert going[21:24].any() != ends
    assert going[26:39].all()


def test_a_millisecond_without_events_ends_rounds() -> None:
    simulator = Simulator(WIDTH, HEIGHT, STORM.changed({"arbiter_scan": AT_ONCE}), seed=2)
    image, found = still(50, WIDTH, HEIGHT), []
    for k6, t_us in ((2e-2, 0), (2e-2, 10_000), (0.0, 15_000), (2e-2, 30_000)):
        simulator.parameters = simulator.parameters.changed({"leak_noise": {"k6": k6}})
        found.append(simulator.advance(image, t_us))
    going = scanned_by_ms(np.concatenate(found))
    assert going[5:10].all()
    assert not going[16:19].any()
    assert going[20:29].all()


def test_it_does_not_matter_how_time_is_cut() -> None:
    scan = {"round_us": ROUND_US, "busy_per_us": 0.01, "steepness": 1.0}
    flash = only(contrast_response={"k1": 2.0}).changed({"arbiter_scan": scan})

    def run(times_us: list[int]) -> Events:
        simulator = Simulator(WIDTH, HEIGHT, flash, seed=6)
        simulator.advance(still(0, WIDTH, HEIGHT), 1_000_000)
        first = [simulator.advance(still(255, WIDTH, HEIGHT), 1_020_000)]
        return np.concatenate([*first, *(simulator.advance(still(255, WIDTH, HEIGHT), t) for t in times_us)])

    once, often = run([1_060_000]), run(list(range(1_020_500, 1_060_001, 500)))
    assert len(once) > 1000
    assert once.tobytes() == often.tobytes()
