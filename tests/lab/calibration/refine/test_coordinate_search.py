"""The search on scores that are formulas: no camera is simulated."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from voltcam_lab.calibration.refine.coordinate_search import CoordinateSearch
from voltcam_lab.calibration.refine.coordinates import (
    ABSENT,
    CORE,
    OFFERED,
    Point,
    parameters_at,
    point_of,
    present,
)
from voltcam_lab.calibration.refine.judge import Judge
from voltcam_lab.calibration.refine.refinement import SLACKS, Refinement
from voltcam_lab.calibration.refine.replay import Replay
from voltcam_lab.distances import FrameLight, Region
from voltcam_lab.distances.goal import Goal
from voltcam_lab.light.grey import WHITE_DN
from voltcam_lab.light.scene import scene_of
from voltcam_simulator import EVENT, Parameters

from .made import START
from .made_search import PLAIN, SCENE, MadeSearch, Score

WAVE_US = np.arange(0, 600_001, 10_000)


def bowl(**best: float) -> Score:
    """1 at the best, more by the squared logarithm of how far each coordinate is from it."""

    def score(point: Point) -> float:
        return 1 + sum(math.log(point[name] / value) ** 2 for name, value in best.items())

    return score


def test_coordinates_are_found_at_the_bottom_of_a_bowl() -> None:
    search = MadeSearch(bowl(gain=12.0, on_over_off=0.8, knee_dn=30.0))
    point, best = search.moved(PLAIN, ("gain", "on_over_off", "knee_dn"), 0.3, 12)
    assert [point[name] for name in ("gain", "on_over_off", "knee_dn")] == pytest.approx(
        [12, 0.8, 30], rel=0.05
    )
    assert best == search.score(point) < 1.01
    assert {name: point[name] for name in CORE[3:]} == {name: PLAIN[name] for name in CORE[3:]}


def test_what_makes_up_for_one_another_is_moved_together() -> None:
    """A valley along which three coordinates change by a factor of 2.7: one by one they get nowhere."""
    names = ("gain", "on_over_off", "period_us")

    class Valley(MadeSearch):
        def residuals(self, point: Point) -> NDArray[np.float64]:
            u, v, w = (math.log(point[name] / PLAIN[name]) for name in names)
            return np.array([1, 10 * (u - v), 10 * (v - w), u + v + w - 3])

    def valley(point: Point) -> float:
        return float(np.sum(search.residuals(point) ** 2))

    search = Valley(valley)
    assert search.moved(PLAIN, names, 0.1, 5)[1] > 5
    assert valley(search.polished(dict(PLAIN), names)) < 1.01


def test_polishing_keeps_the_best_that_it_has_seen() -> None:
    rng = np.random.default_rng(1)

    def noisy(point: Point) -> float:
        return 0.0 if point["gain"] == pytest.approx(12.0, rel=1e-9) else float(rng.uniform(1, 2))

    assert noisy(MadeSearch(noisy).polished(PLAIN | {"gain": 12.0}, ("gain", "period_us"))) == 0


def test_what_is_settled_last_leaves_ends_and_spread_as_they_are() -> None:
    """A bowl whose bottom is elsewhere in all of them."""
    there = PLAIN | {"threshold_spread": 0.05, "pedestal_dn": 4.0, "highlight": 1.5, "slack_dn": 1.0}
    best = {"gain": 12.0, "on_over_off": 0.8, "knee_dn": 30.0}
    fixed = {"threshold_spread": 0.1, "pedestal_dn": 8.0, "highlight": 2.0, "slack_dn": 2.0}

    class Bowl(MadeSearch):
        def residuals(self, point: Point) -> NDArray[np.float64]:
            return np.array([math.log(point[name] / value) for name, value in (best | fixed).items()])

    seen = bowl(**best, **fixed)
    found = Bowl(seen).settled(dict(there))
    assert {name: found[name] for name in best} == pytest.approx(best, rel=0.05)
    assert {name: found[name] for name in fixed} == {name: there[name] for name in fixed}
    assert Bowl(seen, lambda point: 1.0).settled(dict(there)) == there  # pixels that saw no step do not gain


def test_no_step_makes_it_worse_and_the_start_is_left_as_it_was() -> None:
    rng = np.random.default_rng(1)
    given = dict(PLAIN)
    search = MadeSearch(lambda point: float(rng.normal()))
    _, best = search.moved(given, ("gain", "knee_dn"), 0.3, 5, best=-5.0)
    assert best <= -5.0
    assert given == PLAIN


def with_mechanisms(**needed: float) -> Score:
    """As much above 1 as the mechanisms are off; any other one that is there costs a little."""

    def score(point: Point) -> float:
        other = sum(0.01 for name, value in ABSENT.items() if name not in needed and point[name] != value)
        return 1 + other + sum(abs(point[name] - size) / size for name, size in needed.items())

    return score


def test_mechanisms_that_both_parts_need_are_kept_and_no_others() -> None:
    bare = PLAIN | ABSENT
    search = MadeSearch(with_mechanisms(reset_spread=0.08, shot_c=0.01))
    point = search.offered(bare)
    assert {name for name, value in ABSENT.items() if point[name] != value} == {"reset_spread", "shot_c"}
    assert (point["reset_spread"], point["shot_c"]) == pytest.approx((0.08, 0.01), rel=0.1)
    assert len(search.said) == len(OFFERED)


def test_what_helps_only_the_pixels_that_chose_it_is_not_kept() -> None:
    bare = PLAIN | ABSENT
    search = MadeSearch(with_mechanisms(reset_spread=0.08), with_mechanisms())
    assert search.offered(bare) == bare


def test_a_mechanism_that_is_there_stays_unless_another_size_is_closer() -> None:
    there = PLAIN | ABSENT | {"coupling": 0.003}
    assert MadeSearch(with_mechanisms()).offered(there) == there
    nearly_none = PLAIN | ABSENT | {"k4_per_us": 1e-12}
    found = MadeSearch(with_mechanisms(k4_per_us=1e-7)).offered(nearly_none)
    assert found["k4_per_us"] == pytest.approx(1e-7, rel=0.1)


def test_what_is_not_missed_goes() -> None:
    both = PLAIN | ABSENT | {"coupling": 0.003, "reset_spread": 0.08}
    assert present(MadeSearch(with_mechanisms(reset_spread=0.08)).without_needless(both)) == ("reset_spread",)
    missed = MadeSearch(
        with_mechanisms(reset_spread=0.08), with_mechanisms(reset_spread=0.08, coupling=0.003)
    )
    assert present(missed.without_needless(both)) == ("reset_spread", "coupling")


@pytest.mark.parametrize(("pole", "time_constants"), [("cutoff_hz", 2), ("follower_hz", 1)])
def test_a_slower_front_end_takes_its_lag_from_the_delay(pole: str, time_constants: int) -> None:
    """1 / (2 pi f), twice that where light of half of white has half the bandwidth; from then on only the
    change of it. A delay may be before 0."""
    seen: list[Point] = []
    sizes = dict(OFFERED)[pole]

    def score(point: Point) -> float:
        seen.append(dict(point))
        return 2.0 if point[pole] == 0 else 1.0 if point[pole] == sizes[1] else 3.0

    MadeSearch(score).offered(PLAIN | ABSENT)
    delays = {point[pole]: point["delay_us"] for point in seen}
    for size in sizes:
        assert delays[size] == pytest.approx(1000 - time_constants * 1e6 / (2 * math.pi * size))


def test_noise_that_is_error_of_the_light_goes_first() -> None:
    noisy = PLAIN | {"k3": 1e-4, "k6": 1e-5, "reset_spread": 0.1, "period_us": 0.0}
    score = bowl(gain=PLAIN["gain"])
    found = MadeSearch(lambda point: score(point) + point["reset_spread"] + 1e3 * point["k3"]).first(noisy)
    assert found["reset_spread"] == found["k3"] == found["k6"] == 0
    assert found["delay_us"] == PLAIN["delay_us"]  # which has been measured
    assert found["period_us"] > 0


def test_where_there_is_no_such_camera_the_score_is_infinite() -> None:
    """Beyond white the knee is of no consequence; gamma has a limit in the registry."""
    end_us = int(SCENE.t_us[-1])
    region = Region.whole(SCENE.width, SCENE.height, 0, end_us)
    light = FrameLight(SCENE.taken.astype(np.uint8), SCENE.taken_us)
    goal = Goal(np.empty(0, EVENT), region, light)
    search = CoordinateSearch(START, goal, Judge((goal,), 1), SCENE, region, 1, lambda step: None)
    assert math.isfinite(search.score(PLAIN))
    assert np.isfinite(search.unseen(PLAIN)).all()
    for wrong in ({"knee_dn": WHITE_DN + 1}, {"gamma": 99.0}):
        assert search.score(PLAIN | wrong) == math.inf


def recorded(hidden_dn: float, white_dn: float) -> tuple[NDArray[np.void], NDArray[np.uint8], Region]:
    """(events, frames, region) of a wave from 0 to 120 DN. Frames begin at a light and end at a level."""
    light, events, region = waving(60)
    return events, np.rint(np.clip(light - hidden_dn, 0, white_dn)).astype(np.uint8), region


def waving(depth_dn: float | NDArray[np.float64]) -> tuple[NDArray[np.float32], NDArray[np.void], Region]:
    """(light, events, region) of a wave about 60 DN, so deep, or so deep in each column."""
    y, x = np.indices((24, 24))
    light = np.array([60 + depth_dn * np.sin((x + y / 2 - t / 20_000) / 2) for t in WAVE_US], np.float32)
    region = Region.whole(24, 24, 100_000, int(WAVE_US[-1]))
    return light, Replay.of(scene_of(light, WAVE_US, "linear"), region).events(START, seed=2), region


def test_what_black_stands_for_is_found_where_frames_have_it() -> None:
    real, frames, region = recorded(10, 255)
    start = point_of(START) | {"knee_dn": point_of(START)["knee_dn"] + 10}  # as it is where frames tell it
    camera, said = parameters_at(start, START), list[str]()

    def found(taken: NDArray[np.uint8]) -> Parameters:
        scene, light = scene_of(taken, WAVE_US, "linear"), FrameLight(taken, WAVE_US)
        return Refinement(real, scene, light, region, 1, said.append).with_ends(camera)

    assert 7 < found(frames).input_response.pedestal_dn < 14
    assert said == ["refine: pedestal_dn"]
    assert found(frames + 5) is camera
    assert said[1:] == []


def test_what_white_stands_for_is_found_where_frames_have_it() -> None:
    """Full at 80 DN. Light goes to 120, half as much again."""
    real, frames, region = recorded(0, 80)
    scene, light = scene_of(frames, WAVE_US, "linear"), FrameLight(frames, WAVE_US)
    refinement = Refinement(real, replace(scene, white_dn=80.0), light, region, 1)
    found = refinement.with_ends(START).input_response
    assert 1.1 < found.highlight < 1.5
    assert found.white_level_dn == 80
    assert found.pedestal_dn < 3


def test_an_end_stays_as_it_was_where_other_pixels_lose_by_it() -> None:
    def worse(point: Point) -> float:
        return 1 + point["pedestal_dn"]

    def better(point: Point) -> float:
        return 1 / (1 + point["pedestal_dn"])

    assert MadeSearch(better, worse).end(PLAIN, "pedestal_dn", (3.0, 9.0)) == PLAIN
    assert MadeSearch(better).end(PLAIN, "pedestal_dn", (3.0, 9.0))["pedestal_dn"] > 9
    assert MadeSearch(bowl(pedestal_dn=10.0)).end(PLAIN | {"pedestal_dn": 10.0}, "pedestal_dn", (3.0,)) == (
        PLAIN | {"pedestal_dn": 10.0}
    )


def test_thresholds_that_seemed_to_spread_do_so_less_where_recorded_events_do() -> None:
    """The gain goes with it: as many events as a wide spread gave by low thresholds are now made by light."""
    light, real, region = waving(60)
    scene, seen = scene_of(light, WAVE_US, "linear"), FrameLight(light.astype(np.uint8), WAVE_US)
    low = 0.8 * START.contrast_response.k1
    wide = START.changed({"threshold_mismatch": {"sigma": 0.4}, "contrast_response": {"k1": low}})
    found = Refinement(real, scene, seen, region, 1).with_spread_and_slack(wide, 0.3)
    assert found.threshold_mismatch.sigma < 0.13
    events = [Replay.of(scene, region).events(one, seed=4).size for one in (wide, found)]
    assert events[1] == pytest.approx(events[0], rel=0.05)
    assert found.contrast_response.k1 == pytest.approx(START.contrast_response.k1, rel=0.1)


def test_what_comes_no_closer_is_not_traded() -> None:
    search = MadeSearch(lambda point: 1 + point["slack_dn"])
    assert search.traded(PLAIN, "slack_dn", (1.0, 2.0)) == PLAIN
    search = MadeSearch(lambda point: 9 - point["slack_dn"], lambda point: 1.0)
    assert search.traded(PLAIN, "slack_dn", (1.0, 2.0)) == PLAIN
    search = MadeSearch(lambda point: 9 - point["slack_dn"])
    assert search.traded(PLAIN, "slack_dn", (1.0, 2.0))["slack_dn"] == 2.0


@pytest.mark.parametrize("noise_dn", [3.0, 0.0])
def test_noise_of_frames_is_kept_from_the_pixels(noise_dn: float) -> None:
    """The camera saw light that rests but on the left; frames have noise. Without it there is no slack."""
    light, real, region = waving(np.repeat([30.0, 0.0], [6, 18]))
    noise = np.random.default_rng(3).normal(0, noise_dn, light.shape)
    frames = np.rint(np.clip(light + noise, 0, 255)).astype(np.uint8)
    scene, seen = scene_of(frames, WAVE_US, "linear"), FrameLight(frames, WAVE_US)
    found = Refinement(real, scene, seen, region, 1).with_spread_and_slack(START, max(noise_dn, 0.5))
    assert found.frame_noise.slack_dn in [0.0 if noise_dn == 0 else size * noise_dn for size in SLACKS]
    if noise_dn == 0:
        return
    before, after = (Replay.of(scene, region).events(one, seed=4) for one in (START, found))
    expected, with_noise, calm = (np.count_nonzero(each["x"] >= 6) for each in (real, before, after))
    assert calm - expected < 0.4 * (with_noise - expected)
    moving = [np.count_nonzero(each["x"] < 6) for each in (before, after)]
    assert moving[1] == pytest.approx(moving[0], rel=0.05)  # the gain makes up for what a slack takes
