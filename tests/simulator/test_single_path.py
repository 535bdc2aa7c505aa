"""The path of one pixel followed event by event: exact arithmetic without noise, closed laws with it."""

import math

import numpy as np
import pytest
from scipy import stats

from voltcam_simulator.event_key import event_address, unpack
from voltcam_simulator.groups import Reset
from voltcam_simulator.single_path import DEEPEST, Pixel, follow, follow_kicked

P_LIMIT = 1e-4  # chance that a correct sampler would fail one assertion for a random seed
NO_RESET = Reset(0.0, 0.0)
OFFSET_US = 70.0


class Path:
    """One pixel at (3, 1) of a sensor 5 pixels wide, and what it has done."""

    def __init__(
        self, noise2: float = 0.0, above: float = 1.0, below: float = 1.0, seed: int = 1, space: int = 4000
    ) -> None:
        self.pixel = Pixel(noise2, above, below, np.uint64(event_address(8, 5, 1 / 5)), OFFSET_US)
        self.state, self.space = np.uint64(seed), space
        self.voltage = self.free_us = 0.0
        self.written = 0
        self._cuts, self._keys = np.empty((2, DEEPEST + 1)), np.empty(space, np.uint64)

    def follow(self, x: float, y: float, begin: float, end: float, reset: Reset = NO_RESET) -> "Path":
        state, self.written, self.voltage, self.free_us = follow(
            self.state, x, y, begin, end, self.pixel, reset, self._cuts, self._keys, self.written
        )
        self.state = np.uint64(state)
        return self

    def kicked(
        self, x: float, drift: float, now: float, span: float, *kicks: tuple[float, float], dead_us: float = 0
    ) -> "Path":
        times, sizes = (np.array([kick[i] for kick in kicks], np.float64) for i in (0, 1))
        self.written, self.voltage, self.free_us = follow_kicked(
            self.state, x, drift, now, 0.0, span, self.pixel, Reset(dead_us, 0.0), times, sizes,
            self._cuts, self._keys, self.written,
        )  # fmt: skip
        return self

    @property
    def events(self) -> list[tuple[int, bool]]:
        """(time from the start of the step [us], ON?) of each event."""
        keys, n = self._keys[: self.written], self.written
        t, x, y, p = np.empty(n, np.int64), np.empty(n, "<u2"), np.empty(n, "<u2"), np.empty(n, np.bool_)
        unpack(keys, -int(OFFSET_US), t, x, y, p)
        assert set(zip(x.tolist(), y.tolist(), strict=True)) <= {(3, 1)}
        return list(zip(t.tolist(), p.tolist(), strict=True))


def test_without_noise_a_path_is_a_straight_line_with_resets() -> None:
    path = Path(above=1.0, below=0.5).follow(0.25, 3.5, 100.0, 1100.0)
    rate = 3.25 / 1000
    assert path.events == [(100 + math.floor((k - 0.25) / rate), True) for k in (1, 2, 3)]
    assert path.voltage == pytest.approx(0.5)
    assert path.free_us == 1100
    down = Path(above=1.0, below=0.5).follow(0.0, -1.2, 0.0, 1200.0)
    assert [on for _, on in down.events] == [False, False]
    assert down.voltage == pytest.approx(-0.2)


def test_a_dead_time_loses_what_the_path_does_in_it() -> None:
    """1 threshold in 100 us: an event each 100 us + 30 us dead, and 10 us left of the last dead time."""
    path = Path().follow(0.0, 3.8, 0.0, 380.0, Reset(30.0, 0.0))
    assert [t for t, _ in path.events] == [100, 230, 360]
    assert path.free_us == pytest.approx(390)
    assert path.voltage == 0


def test_space_for_events_that_is_full_is_said() -> None:
    path = Path(space=2).follow(0.0, 3.5, 0.0, 350.0)
    assert path.written == -1
    assert Path(space=3).follow(0.0, 3.5, 0.0, 350.0).written == 3


@pytest.mark.parametrize(
    ("kicks", "events", "voltage"),
    [
        ([(50.0, 0.25)], [], 0.75),
        ([(50.0, 0.75)], [(50, True)], 0.25),  # at 0.25 when it is kicked: on the threshold at once
        ([(20.0, -0.5), (80.0, 0.5)], [], 0.5),
        ([(60.0, -2.0)], [(60, False)], 0.2),  # beyond the threshold by a kick: one event, from there to 0
        ([(math.inf, 0.0)], [], 0.5),
    ],
)
def test_kicks_come_at_their_time(
    kicks: list[tuple[float, float]], events: list[tuple[int, bool]], voltage: float
) -> None:
    """The path rises by half a threshold in 100 us beside the kicks."""
    drift = 0.5 + sum(size for _, size in kicks)
    path = Path().kicked(0.0, drift, 0.0, 100.0, *kicks)
    assert path.events == events
    assert path.voltage == pytest.approx(voltage)
    assert path.free_us == 100


@pytest.mark.parametrize(("free_us", "voltage"), [(30.0, 0.35 + 0.6), (50.0, 0.25)])
def test_a_kick_in_the_dead_time_is_lost(free_us: float, voltage: float) -> None:
    """Free from there on, half a threshold in 100 us; the kick is at 40 us."""
    path = Path().kicked(0.0, 1.1, free_us, 100.0, (40.0, 0.6))
    assert path.voltage == pytest.approx(voltage)


def test_noise_between_two_ends_has_the_law_of_a_bridge_in_one_piece() -> None:
    """Far from thresholds a kick of size 0 cuts the path, and its end is N(drift, sigma^2 span) still."""
    ends = [
        Path(noise2=1e-4, above=9, below=9, seed=seed).kicked(0.5, 0.3, 0.0, 100.0, (40.0, 0.0)).voltage
        for seed in range(3000)
    ]
    assert stats.kstest(ends, stats.norm(0.8, 0.1).cdf).pvalue > P_LIMIT


def test_first_exit_of_a_noisy_bridge_that_reaches_both_sides() -> None:
    """Bridge from 0 to 0 in the band (-1, 1): P(inside) = sum of (-1)^k exp(-2 k^2/v), Kolmogorov's law."""
    variance, n = 1.0, 4000
    silent = first_on = 0
    for seed in range(n):
        events = Path(noise2=variance / 1000, seed=seed).follow(0.0, 0.0, 0.0, 1000.0).events
        silent += not events
        first_on += bool(events) and events[0][1]
    inside = float(stats.kstwobign.cdf(1 / math.sqrt(variance)))
    assert stats.binomtest(silent, n, inside).pvalue > P_LIMIT
    assert stats.binomtest(first_on, n - silent, 0.5).pvalue > P_LIMIT


def test_the_voltage_after_a_reset_spreads_and_keeps_off_the_thresholds() -> None:
    """One event at 100 us, then 50 us of half a threshold: the end is 0.5 + N(0, 0.1), cut at 0.9 below."""
    wide = [Path(seed=s).follow(0.0, 1.5, 0.0, 150.0, Reset(0.0, 0.1)).voltage - 0.5 for s in range(2000)]
    kept = [value for value in wide if value > -0.4]  # none crossed a second time
    assert len(kept) == len(wide)
    assert stats.kstest(wide, stats.norm(0, 0.1).cdf).pvalue > P_LIMIT
    held = [
        Path(seed=s, below=0.5).follow(0.0, 1.01, 0.0, 101.0, Reset(0.0, 9.0)).voltage for s in range(200)
    ]
    assert min(held) == pytest.approx(-0.9 * 0.5 + 0.01)
