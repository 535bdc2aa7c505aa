"""Kicks after events, against pixels without noise that are followed microsecond by microsecond."""

from functools import cache

import numpy as np
import pytest

from voltcam_simulator import Limits, Simulator, TooLongError, late_kicks

from .effects.slow_kicks import Fired, slow_kicks
from .scenes import only

WIDTH, HEIGHT, END_US = 5, 4, 60_000
K1, K2 = 8.0, 20.0
OWN = [(0, 0)]
NEIGHBOURS = [(-1, 0), (1, 0), (0, -1), (0, 1)]
CORNERS_US = np.array([0, 15_000, 25_000, 30_000, 48_000, END_US])
"""Between these ln(L + k2) is straight in time, of each pixel with a slope of its own."""


@cache
def corners() -> np.ndarray:
    """(corners, height, width) ln(L + k2)."""
    return np.random.default_rng(4).uniform(np.log(30), np.log(250), (len(CORNERS_US), HEIGHT, WIDTH))


def log_light(t_us: float) -> np.ndarray:
    gap = min(int(np.searchsorted(CORNERS_US, t_us, side="right")) - 1, len(CORNERS_US) - 2)
    share = (t_us - CORNERS_US[gap]) / (CORNERS_US[gap + 1] - CORNERS_US[gap])
    levels = corners()
    return (1 - share) * levels[gap] + share * levels[gap + 1]


def simulated(times_us: np.ndarray, **changes: object) -> Fired:
    parameters = only(contrast_response={"k1": K1, "k2_dn": K2}, **changes)
    camera = Simulator(WIDTH, HEIGHT, parameters, seed=3)
    images = [(np.exp(log_light(t)) - K2).astype(np.float32) for t in times_us]
    camera.advance(images[0], -500)  # so that the effect knows where the pixels are when they begin to move
    events = np.concatenate(
        [camera.advance(image, int(t)) for image, t in zip(images, times_us, strict=True)]
    )
    return [(int(t), int(x), int(y), bool(p)) for t, x, y, p in events.tolist()]


def path(t_us: int) -> np.ndarray:
    return start() + K1 * (log_light(t_us) - log_light(0))


@cache
def start() -> np.ndarray:
    """(height, width) voltages at 0, anywhere between the thresholds: of each pixel's first event."""
    voltages = np.zeros((HEIGHT, WIDTH))
    for t, x, y, on in reversed(simulated(CORNERS_US)):
        voltages[y, x] = (1 if on else -1) - K1 * (log_light(t) - log_light(0))[y, x]
    return voltages


def fine() -> np.ndarray:
    return np.arange(0, END_US + 1, 500)


def uneven() -> np.ndarray:
    return np.unique(np.concatenate([CORNERS_US, np.random.default_rng(5).integers(0, END_US, 40)]))


CASES = [
    ("residual_kick", {"after_on": 0.23, "after_off": -0.17, "delay_us": 700}, OWN),
    ("residual_kick", {"after_on": -0.31, "after_off": 0.37, "delay_us": 3000}, OWN),
    ("residual_kick", {"after_on": -3.0, "after_off": 0.0, "delay_us": 900}, OWN),
    ("residual_coupling", {"after_on": 0.33, "after_off": -0.21, "delay_us": 1500}, NEIGHBOURS),
    ("residual_coupling", {"after_on": 0.0, "after_off": 2.5, "delay_us": 0}, NEIGHBOURS),
]
COMPARED_US = {"residual_kick": END_US, "residual_coupling": 10_000}
"""Later, coupled pixels have another history: a microsecond lay between a kick and an event that it met."""


def share_found(found: Fired, wanted: Fired, until_us: int, within_us: int = 50) -> float:
    """Of the wanted events, those that the same pixel has with the same sign at about that time: stamps
    are whole microseconds, which a slow pixel makes up for late."""
    times: dict[tuple[int, int, bool], list[int]] = {}
    for t, *address in found:
        times.setdefault(tuple(address), []).append(t)
    met = [
        any(abs(t - other) <= within_us for other in times.get(tuple(address), []))
        for t, *address in wanted
        if t <= until_us
    ]
    assert len(met) > 50
    return float(np.mean(met))


@pytest.mark.parametrize("times_us", [fine(), CORNERS_US, uneven()], ids=["fine", "coarse", "uneven"])
@pytest.mark.parametrize(("name", "numbers", "targets"), CASES)
def test_without_noise_events_are_those_of_the_slow_twin_however_time_is_cut(
    name: str, numbers: dict[str, float], targets: list[tuple[int, int]], times_us: np.ndarray
) -> None:
    after = {True: numbers["after_on"], False: numbers["after_off"]}
    wanted = slow_kicks(path, END_US, after, int(numbers["delay_us"]), targets)
    found, plain, until = simulated(times_us, **{name: numbers}), simulated(times_us), COMPARED_US[name]
    assert share_found(plain, wanted, until) < 0.7
    assert share_found(found, wanted, until) > 0.9
    assert share_found(wanted, found, until) > 0.9


def test_dead_times_hold_and_kicks_within_them_are_lost() -> None:
    dead = {"refractory_period": {"period_us": 2000}}
    kick = {"after_on": 3.0, "after_off": 3.0, "delay_us": 2500}
    for numbers, lost in ((kick, False), (kick | {"delay_us": 1500}, True)):
        found = simulated(fine(), residual_kick=numbers, **dead)
        times: dict[tuple[int, int], list[int]] = {}
        for t, x, y, _ in found:
            times.setdefault((x, y), []).append(t)
        gaps = np.concatenate([np.diff(one) for one in times.values()])
        assert gaps.min() >= 1999
        assert (np.count_nonzero(gaps == 2500) > 100) != lost
        if lost:
            assert found == simulated(fine(), **dead)


def test_a_walk_in_many_parts_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    name, numbers, _ = CASES[-2]
    whole = simulated(CORNERS_US, **{name: numbers})
    monkeypatch.setattr(late_kicks, "MOST_STEPS", 7)
    assert simulated(CORNERS_US, **{name: numbers}) == whole
    assert len(whole) > 100 * 7 / 2


def test_a_long_walk_is_given_up_when_it_is_late() -> None:
    """Nine million events of pixels that kick each other: in one part it would not be asked again."""
    endless = {"after_on": 10.0, "after_off": 10.0, "delay_us": 100_000}
    camera = Simulator(
        64, 48, only(residual_coupling=endless, hot_pixels={"fraction": 1.0, "rate_hz": 1000.0})
    )
    image, asked = np.full((48, 64), 100, np.uint8), 0

    def late() -> bool:
        nonlocal asked
        asked += 1
        return asked > 5

    camera.advance(image, 0)
    camera.advance(image, 100_000)
    with pytest.raises(TooLongError):
        camera.advance(image, 1_000_000, Limits(late=late))
    assert asked == 6
