"""One camera, two recordings: what a pair shares and what not, how it is judged, that runs go on; and one
tiny pair for real."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.pairs_study.hidden_camera import draw_camera, true_file
from tests.pairs_study.judge import MEASURED, Outcome, Row, calibrated, judged
from tests.pairs_study.page import page
from tests.pairs_study.pairs import APART, FPS, LIGHT, REPORTED_FROM, Pair, pairs
from tests.pairs_study.run import read, run

from voltcam_lab.health import Inspection
from voltcam_simulator import Parameters

TINY = Pair(11, width=32, height=32, seconds=2.5)
NEAR = Row(W1=0.1, TVs=0.1, pair=0.1, lag_us=0.0, on=1.0, off=1.0)


def test_a_pair_is_one_camera_on_two_scenes_in_two_lights() -> None:
    first, second = (TINY.recording(which) for which in (0, 1))
    for name in ("theta_on_factor", "leak_factor", "hot_pixels", "hot_hz"):
        assert np.array_equal(first.truth["patterns"][name], second.truth["patterns"][name])
    assert first.truth["base"] == second.truth["base"]
    assert first.truth["effects"] == second.truth["effects"]
    assert not np.array_equal(first.frames, second.frames)
    low, high = sorted(TINY.light)
    assert LIGHT[0] <= low <= high / APART <= LIGHT[1] / APART
    assert FPS[0] <= first.truth["film"]["fps"] <= FPS[1]
    assert first.frames.dtype == np.uint8


def test_another_run_is_of_the_same_scene_with_other_noise() -> None:
    one, other = TINY.recording(1), TINY.recording(1, run=1)
    assert np.array_equal(one.frames, other.frames)
    assert not np.array_equal(one.events, other.events)
    assert len(one.events) == pytest.approx(len(other.events), rel=0.05)  # .5 % by Poisson's law


def test_the_scenes_of_the_report_are_of_both_kinds() -> None:
    drawn = pairs(20)
    assert {pair.fine for pair in drawn} == {(False, False), (False, True), (True, False), (True, True)}
    assert [pair.seed for pair in drawn] == list(range(REPORTED_FROM, REPORTED_FROM + 20))


def test_the_true_file_has_all_that_the_camera_has() -> None:
    camera = draw_camera(np.random.default_rng(1), 30.0)
    active = {effect.name for effect in true_file(camera, 36).effects() if effect.active}
    assert {effect.name for effect in camera.effects} <= active
    aps = true_file(camera, 36).aps_coupling
    exposed = aps.times(36)
    begin_us = aps.offset_us + exposed.exposed_ns / 1000
    assert begin_us == pytest.approx(-camera.exposure_us / 2, abs=0.01)  # of the frame stamped 0
    assert exposed.read_ns - exposed.exposed_ns == pytest.approx(1000 * camera.exposure_us, abs=1)


TRUE = true_file(TINY.camera, TINY.height)
WRONG = TRUE.changed({"comparator": {"theta_on": 3.0, "theta_off": 3.0}})


def true_one(_: Inspection) -> tuple[Parameters, Parameters]:
    return TRUE, WRONG


def nothing_like_it(_: Inspection) -> tuple[Parameters, Parameters]:
    return WRONG, TRUE


def test_the_true_values_are_as_near_as_they_are() -> None:
    outcome = judged(TINY, true_one)
    assert [outcome.ratio(name) for name in MEASURED] == [1.0, 1.0, 1.0]
    assert outcome.ratio("W1", likeliest=True) > 1.5
    assert outcome.again is not None
    assert outcome.true is not None
    assert outcome.again.W1 < outcome.true.W1
    assert outcome.again.on == pytest.approx(1, abs=0.05)
    assert outcome.delay_us == outcome.true_delay_us > 0


def test_another_camera_is_farther() -> None:
    assert judged(TINY, nothing_like_it).ratio("W1") > 1.5


def test_what_is_not_there_is_infinitely_far() -> None:
    assert Outcome(seed=1, error="no").ratio("W1") == math.inf
    assert Outcome(seed=1, error="no").late_us == math.inf


def fails(pair: Pair) -> Outcome:
    if pair.seed == 2:
        raise ValueError("no | such\ncamera")
    return Outcome(seed=pair.seed, true=NEAR, calibrated=NEAR, likeliest=NEAR, again=NEAR)


def test_runs_go_on_and_errors_are_kept(tmp_path: Path) -> None:
    file, three = tmp_path / "new" / "pairs.jsonl", [Pair(1), Pair(2), Pair(3)]
    assert [one.seed for one in run(three[:1], file, 1, fails)] == [1]
    with file.open("a") as results:
        results.write('{"seed": 2, "co')  # killed there
    assert sorted(one.seed for one in run(three, file, 2, fails)) == [2, 3]
    assert [one.error for one in read(file) if one.seed == 2] == ["ValueError: no | such\ncamera"]
    assert list(run(three, file, 1, fails)) == []


def test_the_page_has_what_came_of_each() -> None:
    two = pairs(3)
    late = NEAR.model_copy(update={"lag_us": -1500.0, "W1": 0.16})
    good = Outcome(seed=two[0].seed, true=NEAR, calibrated=NEAR, likeliest=NEAR, again=NEAR)
    bad = Outcome(seed=two[1].seed, true=NEAR, calibrated=late, likeliest=NEAR, again=NEAR, delay_us=10)
    text = page(two, [bad, good, Outcome(seed=two[2].seed, error="no |\nluck"), replace_seed(good, 1)])
    assert "Not finished" not in text
    assert "| W1, over that of the true values | at most 1.5 | 1.30 | 1.60 | 1 of 3 |" in text
    assert "| the same without refinement |  | 1.00 | 1.00 | 2 of 3 |" in text
    assert "| events late or early, ms | at most 1 | 0.75 | 1.50 | 1 of 3 |" in text
    assert "| the same with the true values |  | 0.00 | 0.00 | 2 of 3 |" in text
    assert f"```text\n{two[2].seed}: no | luck\n```" in text
    assert "| 1 |" not in text
    assert "1 of 3 have run" in page(two, [good])
    assert "Nothing has run." in page(two, [])


def replace_seed(outcome: Outcome, seed: int) -> Outcome:
    return outcome.model_copy(update={"seed": seed})


def test_a_tiny_pair_for_real() -> None:
    """2.5 s of 32 x 32 pixels tell little: within a factor that a wrong camera does not reach."""
    outcome = judged(replace(TINY, seed=12), lambda seen: calibrated(seen, refining=False))
    assert not outcome.error
    assert outcome.ratio("W1") < 3
    assert abs(outcome.late_us) < 10_000
    assert outcome.parameters["contrast_response"]["k1"] > 0
