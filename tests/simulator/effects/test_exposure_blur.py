"""Exposure blur: a sudden change of light takes the exposure to arrive, in a straight line."""

import math
import threading
import time

import numpy as np
import pytest

from voltcam_simulator import Simulator
from voltcam_simulator.effects import exposure_blur

from ..scenes import only, still

K1, EXPOSURE_US = 100.0, 10_000
FIRST, LAST = 20.0, 220.0


def counts(
    times_us: list[int], width: int = 20, height: int = 20, exposure_us: float = EXPOSURE_US
) -> np.ndarray:
    """Events for each pixel up to each time after a sudden change."""
    parameters = only(contrast_response={"k1": K1}, exposure_blur={"exposure_us": exposure_us})
    simulator = Simulator(width, height, parameters, seed=1)
    t0_us = 10**15
    for t_us in (0, 3000, 50_000):
        assert len(simulator.advance(still(FIRST, width, height), t0_us + t_us)) == 0
    found = len(simulator.advance(still(LAST, width, height), t0_us + 50_001))
    totals = []
    for t_us in times_us:
        found += len(simulator.advance(still(LAST, width, height), t0_us + 50_001 + t_us))
        totals.append(found / (width * height))
    return np.array(totals)


def expected(times_us: list[int], exposure_us: float = EXPOSURE_US) -> list[float]:
    shares = [min((t_us + 0.5) / exposure_us, 1) for t_us in times_us]  # the change itself took 1 us
    return [K1 * math.log((FIRST + 20 + s * (LAST - FIRST)) / (FIRST + 20)) for s in shares]


@pytest.mark.parametrize(
    "times_us",
    [[40_000], [5000, 40_000], [9999, 30_000], [1, 2500, 2501, 9999, 10_000], list(range(700, 15_000, 700))],
    ids=["one step", "two", "up to the end", "uneven", "many"],
)  # fmt: skip
def test_the_light_is_the_mean_over_the_exposure_however_time_is_cut(times_us: list[int]) -> None:
    # the start is a tent: half an event is lost to rounding down, as soon as there are some
    np.testing.assert_allclose(
        counts(times_us) + 0.5, expected(times_us), atol=0.2 if times_us[0] > 9 else 0.6
    )


def test_all_rows_see_the_same() -> None:
    """Three bands of rows, which share the instants that are kept."""
    times_us = [2500, 5000, 9000, 12_000]
    np.testing.assert_allclose(counts(times_us, 200, 200) + 0.5, expected(times_us), atol=0.2)


def test_an_exposure_of_more_steps_than_are_kept_is_cut_to_them() -> None:
    times_us = list(range(100, 8001, 100))
    np.testing.assert_allclose(
        counts(times_us)[40:], K1 * math.log((LAST + 20) / (FIRST + 20)) - 0.5, atol=0.2
    )


def test_a_still_scene_stays_still() -> None:
    parameters = only(contrast_response={"k1": 1000}, exposure_blur={"exposure_us": 777})
    simulator = Simulator(8, 8, parameters, seed=1)
    noise = np.random.default_rng(1)
    image = noise.uniform(0, 255, (8, 8)).astype(np.float32)
    assert sum(len(simulator.advance(image, int(t))) for t in np.cumsum(noise.integers(1, 5000, 50))) == 0


def test_an_exposure_shorter_than_the_clock_tells_is_none() -> None:
    """At times of this century a double tells a quarter of a microsecond: the mean was one over nothing."""
    runs = []
    for exposure_us in (0, 1e-3):
        simulator = Simulator(
            8, 8, only(contrast_response={"k1": 60}, exposure_blur={"exposure_us": exposure_us})
        )
        simulator.advance(np.full((8, 8), FIRST, np.uint8), 1_764_000_000_000_000)
        runs.append(simulator.advance(np.full((8, 8), LAST, np.uint8), 1_764_000_000_010_000))
    np.testing.assert_array_equal(*runs)
    assert runs[0].size > 64


def test_threads_that_work_on_bands_of_one_step_place_its_light_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each would find the same place free, and two places would hold light of one time."""
    real, here, most = exposure_blur.place, threading.Semaphore(1), []

    def place(times_us: np.ndarray, begin_us: float, end_us: float) -> int:
        most.append(here.acquire(blocking=False))
        time.sleep(0.002)  # long enough for the other thread to come
        index = real(times_us, begin_us, end_us)
        if most[-1]:
            here.release()
        return index

    monkeypatch.setattr(exposure_blur, "place", place)
    simulator = Simulator(40, 30, only(exposure_blur={"exposure_us": 3000}), seed=1, threads=3)
    for frame in range(8):
        simulator.advance(still(10 * frame, 40, 30), 1000 * frame)
    assert len(most) >= 3 * 7
    assert all(most)
