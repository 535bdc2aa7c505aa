"""Which camera is closer: by more than draws differ, in what light can tell."""

import numpy as np
import pytest
from scipy.stats import binom

from voltcam_lab.calibration.refine.judge import DRAWS, SURE, Judge, closer
from voltcam_lab.calibration.refine.replay import Replay
from voltcam_lab.distances import FrameLight, Region
from voltcam_lab.distances.goal import Goal

from .made import START, wave

BEFORE = np.full((1, DRAWS), 2.0)
LUCK = np.linspace(-0.1, 0.1, DRAWS)


def test_a_camera_is_closer_if_it_is_so_by_more_than_draws_differ() -> None:
    assert closer(BEFORE - 0.2 + LUCK, BEFORE)
    assert not closer(BEFORE - 0.02 + LUCK, BEFORE)
    assert not closer(BEFORE + 0.2 + LUCK, BEFORE)
    assert not closer(BEFORE, BEFORE)


def test_luck_that_both_cameras_have_is_no_difference() -> None:
    assert closer(BEFORE - 0.02 + LUCK, BEFORE + LUCK)


def test_where_known_light_cannot_tell_all_events_decide() -> None:
    untold, better, worse = (BEFORE + change + LUCK for change in (-0.01, -0.3, 0.3))
    both = np.concatenate([BEFORE, BEFORE])
    assert closer(np.concatenate([untold, better]), both)
    assert not closer(np.concatenate([untold, worse]), both)
    assert closer(np.concatenate([better, worse]), both)
    assert not closer(np.concatenate([worse, better]), both)


def test_of_cameras_that_are_alike_few_are_closer() -> None:
    """One in twenty; more than the bound would come of one in ten thousand such tests."""
    rng = np.random.default_rng(1)
    told = sum(closer(*rng.normal(2.0, 0.1, (2, 1, DRAWS))) for _ in range(2000))
    low, high = binom.ppf([5e-5, 1 - 5e-5], 2000, 1 - SURE)
    assert low <= told <= high


@pytest.mark.parametrize("k1", [6.0, 14.0])
def test_the_camera_that_made_the_events_is_closer_than_another(k1: float) -> None:
    scene = wave(0.4)
    region = Region.whole(scene.width, scene.height, 50_000, int(scene.t_us[-1]))
    replay = Replay.of(scene, region)
    goal = Goal(
        replay.events(START, seed=9), region, FrameLight(scene.taken.astype(np.uint8), scene.taken_us)
    )
    judge = Judge((goal,), seed=1)
    own, other = (judge.scores(replay, START.changed({"contrast_response": {"k1": k}})) for k in (9.0, k1))
    assert own.shape == (1, DRAWS)
    assert np.unique(own).size == DRAWS
    assert closer(own, other)
    assert not closer(other, own)
