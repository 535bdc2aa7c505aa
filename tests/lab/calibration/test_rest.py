"""How long pixels wait for their first event."""

import numpy as np
import pytest

from voltcam_client.encodings import EVENT
from voltcam_lab.calibration.rest import BLUR, GROUPS, LEAST_US, WAIT, Rest, log_likelihood, rest_of, waits
from voltcam_lab.health.light_change import light_change_of
from voltcam_lab.light.scene import Scene, scene_of
from voltcam_lab.windows import Mask

PERIOD_US = 10_000


def events(*rows: tuple[int, int, int, bool]) -> np.ndarray:
    return np.array(sorted(rows), EVENT)


EVERYWHERE = np.ones((3, 2), np.bool_)


def still(frames: int = 300) -> Scene:
    images = np.full((frames, 3, 2), 100, np.uint8)
    return scene_of(images, PERIOD_US * np.arange(frames, dtype=np.int64), "linear")


def test_waits_last_until_the_first_event() -> None:
    scene = still()
    mask = Mask(np.array([[1_000_000, 1_100_000]]))
    some = events(
        (500_000, 0, 0, True), (700_000, 0, 0, True), (900_000, 1, 0, False), (1_050_000, 0, 1, True)
    )
    found = waits(some, rest_of(scene), EVERYWHERE, mask)
    ended = {int(one["pixel"]): (float(one["wait_us"]), int(one["end"])) for one in found[:3]}
    assert ended == {0: (500_000, 1), 1: (900_000, -1), 2: (1_000_000, 0)}
    silent = found[3:]
    assert silent["count"].sum() == 3
    assert silent["wait_us"] == pytest.approx(2_990_000 - 100_000)


def test_waits_have_the_law_of_a_leak_and_of_noise() -> None:
    """What is lost of survival is what ends, by leak or noise, ON or OFF."""
    t_us = np.linspace(1e3, 6e6, 6000)
    found = np.zeros((3, t_us.size), WAIT)
    found["wait_us"], found["count"], found["end"] = t_us, 1, np.array([[0], [1], [-1]])
    leak, noise = np.full(t_us.size, 4e-7), np.full(t_us.size, 1e-7)
    alive, on, off = (np.exp(log_likelihood(row, leak, noise, 1.0)) for row in found)
    assert alive[0] == pytest.approx(1, abs=0.01)
    assert on + off == pytest.approx(-np.gradient(alive, t_us), rel=0.01, abs=1e-11)
    early = t_us < 1e6  # uniform and exponential, before the end of the uniform one
    assert alive[early] == pytest.approx(((1 - 4e-7 * t_us) * np.exp(-1e-7 * t_us))[early], abs=0.01)


def test_long_silence_speaks_against_leak_however_large() -> None:
    found = np.zeros(4, WAIT)
    found["wait_us"], found["count"] = 2e6, 1
    silent = log_likelihood(found, np.array([1e-8, 1e-7, 1e-6, 1e-5]), np.full(4, 1e-12), 1.0)
    assert (np.diff(silent) < -0.01).all()


def test_the_longest_rest_of_each_pixel_is_that_of_a_slow_search() -> None:
    """Levels that jump now and then."""
    rng = np.random.default_rng(4)
    jumps = rng.random((200, 3, 2)) < 0.003
    images = (60 + 40 * (np.cumsum(jumps, axis=0) % 3)).astype(np.uint8)
    scene = scene_of(images, PERIOD_US * np.arange(200, dtype=np.int64), "linear")
    at_rest = light_change_of(scene.taken, scene.taken_us).at_rest
    found = rest_of(scene)
    assert found.level_dn == pytest.approx(images.mean(axis=0))
    rested = 0
    for y, x in np.ndindex(3, 2):
        runs, begin = [], None
        for k, still_now in enumerate([*at_rest[:, y, x], False]):
            if still_now and begin is None:
                begin = k
            elif not still_now and begin is not None:
                runs.append((k - begin, begin))
                begin = None
        longest = max((length for length, _ in runs), default=0)
        assert found.end_us[y, x] - found.begin_us[y, x] == PERIOD_US * longest
        rested += longest > 0
        if longest:
            assert found.begin_us[y, x] // PERIOD_US in [begin for length, begin in runs if length == longest]
    assert rested > 3


def test_short_rests_and_pixels_left_out_have_no_wait() -> None:
    level = np.full((1, 4), 100, np.float32)
    begin = np.zeros((1, 4), np.int64)
    end = np.array([[LEAST_US - 1, LEAST_US, 10 * LEAST_US, 10 * LEAST_US]])
    keep = np.array([[True, True, True, False]])
    rows = np.array([(t, x, 0, True) for x in range(4) for t in (100, LEAST_US + 5)], EVENT)
    found = waits(np.sort(rows, order="t"), Rest(level, begin, end), keep, np.zeros((0, 2), np.int64))
    assert found["pixel"].tolist() == [1, 2]
    assert found["wait_us"].tolist() == [100, 100]


def test_silent_pixels_are_grouped_by_level_and_none_is_lost() -> None:
    """More of them than groups: each group has pixels alike."""
    n = 2 * GROUPS + 7
    level = np.random.default_rng(5).uniform(5, 250, (1, n)).astype(np.float32)
    rest = Rest(level, np.zeros((1, n), np.int64), np.full((1, n), 10**6))
    found = waits(np.empty(0, EVENT), rest, np.ones((1, n), bool), np.zeros((0, 2), np.int64))
    assert len(found) == GROUPS
    assert found["count"].sum() == n
    assert (found["count"] * found["level"]).sum() == pytest.approx(level.sum(), rel=1e-5)
    assert (np.diff(found["level"]) >= 0).all()


def test_drawn_waits_are_likeliest_at_about_their_own_leak() -> None:
    """Uniform in 0..1/leak: of 4000, the end is told by what comes late, and blurred by BLUR."""
    found = np.zeros(4000, WAIT)
    found["wait_us"] = np.random.default_rng(6).uniform(0, 1 / 3e-7, 4000)
    found["end"] = found["count"] = 1
    leaks = 3e-7 * np.exp(np.linspace(-0.5, 0.5, 41))
    total = [log_likelihood(found, np.full(4000, leak), np.full(4000, 1e-12), 1.0).sum() for leak in leaks]
    assert leaks[int(np.argmax(total))] == pytest.approx(3e-7, rel=2 * BLUR)
