"""A kick after the pixel's own event, by its signature: at one interval there are more events, or fewer."""

import math

import numpy as np
import pytest

from voltcam_simulator import Simulator

from ..scenes import Events, intervals_us, only, watch_still

SIDE, SECONDS = 60, 2.0
LEAK = {"k4_per_us": 2e-6}


def at_rest(**changes: object) -> Events:
    parameters = only(junction_leak=LEAK, **changes)
    return watch_still(Simulator(SIDE, SIDE, parameters, seed=8), 100, SECONDS, 50)


@pytest.mark.parametrize("chance", [0.2, 1.0])
def test_an_echo_follows_with_its_chance_after_its_delay(chance: float) -> None:
    kick = {"after_on": -5.0, "chance": chance, "delay_us": 3000, "spread_decades": 0.1}
    events = at_rest(residual_kick=kick)
    on, off = events[events["p"]], events[~events["p"]]
    # those of the last delays are still to come
    assert len(off) == pytest.approx(chance * len(on), abs=5 * math.sqrt(len(on)) * (1 - chance) + 120)
    pixel_of = {}
    delays = []
    for t, x, y, p in events.tolist():
        if p:
            pixel_of[x, y] = t
        else:
            delays.append(t - pixel_of[x, y])
    log = np.log10(delays)
    assert np.median(log) == pytest.approx(math.log10(3000), abs=5 * 1.26 * 0.1 / math.sqrt(len(log)))
    assert log.std() == pytest.approx(0.1, rel=5 / math.sqrt(2 * len(log)))


@pytest.mark.parametrize("size", [-0.5, 0.25])
def test_a_kick_that_sets_nothing_off_moves_the_next_event(size: float) -> None:
    intervals = intervals_us(at_rest(residual_kick={"after_on": size, "delay_us": 10_000}), SIDE)
    assert len(intervals) > 1000
    assert intervals == pytest.approx((1 - size) * 500_000, abs=3)  # a drift of 2 thresholds/s


def test_each_polarity_has_a_kick_of_its_own() -> None:
    noise = {"k6": 3e-3}
    echo = {"after_off": 5.0, "delay_us": 200}
    events = at_rest(leak_noise=noise, residual_kick=echo)
    pixel = events["y"].astype(int) * SIDE + events["x"]
    order = np.lexsort((events["t"], pixel))
    p, gap = events["p"][order], np.diff(events["t"][order])
    echoes = (np.diff(pixel[order]) == 0) & (gap == 200)
    assert echoes.sum() > 500
    assert not p[:-1][echoes].any()
    assert p[1:][echoes].all()
