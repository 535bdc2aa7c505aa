"""Frame noise: light that stays behind the frames, as the play operator has it."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from voltcam_simulator import Simulator
from voltcam_simulator.effects.frame_noise import follow

from ..scenes import only, still

K1, DARK_DN = 100.0, 20.0


def counts(levels: list[float], slack_dn: float, steps: int = 1) -> np.ndarray:
    """(ON, OFF) events for each pixel on the way over these grey levels, each way in so many frames."""
    simulator = Simulator(
        20, 20, only(contrast_response={"k1": K1}, frame_noise={"slack_dn": slack_dn}), seed=1
    )
    shares = np.arange(1, steps + 1) / steps
    path = [first + share * (last - first) for first, last in pairwise(levels) for share in shares]
    frames = enumerate([levels[0], *path])
    events = np.concatenate([simulator.advance(still(level, 20, 20), 1000 * t) for t, level in frames])
    return np.array([np.count_nonzero(events["p"] == p) for p in (True, False)]) / 400


def contrast(first: float, last: float) -> float:
    return K1 * math.log((last + DARK_DN) / (first + DARK_DN))


@pytest.mark.parametrize("steps", [1, 7])
def test_light_stays_behind_by_the_slack_whichever_way_and_however_it_is_cut(steps: int) -> None:
    on, off = counts([50, 100, 60], 3.0, steps)
    assert on == pytest.approx(contrast(50, 97), abs=1)
    assert off == pytest.approx(contrast(63, 97), abs=1)


def test_within_the_band_nothing_moves() -> None:
    rng = np.random.default_rng(1)
    assert counts([80.0, *rng.uniform(80 - 3, 80 + 3, 50)], 3.01).sum() == 0
    assert counts([80.0, *rng.uniform(80 - 3, 80 + 3, 50)], 0.0).sum() > 10


def test_no_slack_is_no_effect() -> None:
    assert counts([50, 100, 60], 0.0) == pytest.approx([contrast(50, 100), contrast(60, 100)], abs=1)


def test_a_jump_to_an_image_is_seen_as_it_is() -> None:
    simulator = Simulator(20, 20, only(contrast_response={"k1": K1}, frame_noise={"slack_dn": 3.0}), seed=1)
    simulator.advance(still(200, 20, 20), 0)
    simulator.jump(still(50, 20, 20), 1000)
    events = simulator.advance(still(100, 20, 20), 2000)
    assert events.size / 400 == pytest.approx(contrast(50, 97), abs=1)


def test_under_still_frames_light_stays_where_it_is() -> None:
    """Told by a leak of 100 events a second for each DN of light; rows that stand still are drawn ahead."""
    parameters = only(parasitic_photocurrent={"k5_per_dn_us": 1e-4}, frame_noise={"slack_dn": 3.0})
    simulator = Simulator(20, 20, parameters, seed=1)
    simulator.advance(still(50, 20, 20), 0)
    simulator.advance(still(100, 20, 20), 1000)
    events = [simulator.advance(still(100, 20, 20), t) for t in range(11_000, 1_001_001, 10_000)]
    assert sum(map(len, events)) / 400 == pytest.approx(97 * 100, rel=1e-3)


@given(st.lists(st.floats(0, 255, width=32), min_size=1, max_size=30), st.floats(0, 100, width=32))
def test_the_kernel_is_the_play_operator(frames: list[float], slack: float) -> None:
    """Beside a plain one. Light is never negative, nor further from a frame than the slack."""
    level, plain = np.array([frames[0]], np.float32), np.float32(frames[0])
    for frame in np.array(frames, np.float32):
        light = np.array([frame])
        follow(light, np.float32(slack), level)
        plain = np.clip(plain, frame - np.float32(slack), frame + np.float32(slack))
        assert light[0] == level[0] == plain >= 0
