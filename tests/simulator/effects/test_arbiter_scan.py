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


def test_episodes_take_their_share_of_the_time() -> None:
    """200 episodes of either kind: the share is known to 5 %, and 4 standard deviations are asked for."""
    events = scanned(round_us=ROUND_US, share=0.3, episode_us=3000.0)
    slices = events["t"] // 1000
    busy = np.bincount(slices)
    on = np.bincount(slices, phase_error(events) <= 1 / ROUND_US) / np.maximum(busy, 1)
    share = (on[busy > 5] > 0.5).mean()
    assert share == pytest.approx(0.3, abs=0.08)
    changes = np.abs(np.diff(on > 0.5)).sum()
    assert changes / 2 == pytest.approx(2e6 * 0.3 / 3000, rel=0.35)


def test_it_does_not_matter_how_time_is_cut() -> None:
    scan = {"round_us": ROUND_US, "share": 0.5, "episode_us": 1000.0}
    flash = only(contrast_response={"k1": 2.0}).changed({"arbiter_scan": scan})

    def run(times_us: list[int]) -> Events:
        simulator = Simulator(WIDTH, HEIGHT, flash, seed=6)
        simulator.advance(still(0, WIDTH, HEIGHT), 1_000_000)
        first = [simulator.advance(still(255, WIDTH, HEIGHT), 1_020_000)]
        return np.concatenate([*first, *(simulator.advance(still(255, WIDTH, HEIGHT), t) for t in times_us)])

    once, often = run([1_060_000]), run(list(range(1_020_500, 1_060_001, 500)))
    assert len(once) > 1000
    assert once.tobytes() == often.tobytes()
