"""All pixels, held against simulated ones where the light is known."""

from dataclasses import replace

import numpy as np
import pytest
from tests.generator import draw_base, draw_scene, record

from voltcam_client.formats import Recording
from voltcam_lab.dependence.covariates import COVARIATES, Look
from voltcam_lab.dependence.told_apart import Telling, ToldApart
from voltcam_lab.diagnosis.rig.settings import DEFAULT_RECORDING, DEFAULT_RIG
from voltcam_lab.diagnosis.rig.whole import LeftOpen, Remains, WholeSensor
from voltcam_lab.diagnosis.session import whole_sensor
from voltcam_lab.light.frame_light import FrameLight
from voltcam_lab.recordings import Footage, with_frames
from voltcam_simulator import Parameters

WIDTH, HEIGHT, SECONDS, FPS = 32, 24, 6.0, 30.0
CAMERA = Parameters.of("paper")


@pytest.fixture(scope="module")
def footage() -> Footage:
    """So fast for 30 frames a second that of most light nobody knows how it went."""
    rng = np.random.default_rng(6)
    scene, base = draw_scene(rng, WIDTH, HEIGHT), draw_base(rng, asymmetry=0.0, camera="davis346")
    made = record(scene, base, (), SECONDS, FPS, seed=7)
    return with_frames(Recording(made.events, WIDTH, HEIGHT, made.frames, made.frame_t_us))


def sensor(footage: Footage) -> WholeSensor:
    return whole_sensor(footage, DEFAULT_RECORDING, replace(DEFAULT_RIG, versions=2), 0)


def test_what_happens_in_light_that_is_not_known_makes_no_difference(footage: Footage) -> None:
    """Neither as events that are judged nor as anybody's past."""
    whole = sensor(footage)
    known = whole.recorded
    assert 0.02 < len(known) / len(footage.events) < 0.7
    bare = sensor(replace(footage, events=known))
    assert (bare.recorded == known).all()
    told, again = (one.remains(CAMERA, steps=1).told for one in (whole, bare))
    assert told.events[0] >= 500
    assert (again.events, again.light, again.alone) == (told.events, told.light, told.alone)


def test_first_events_after_light_that_is_not_known_are_not_judged(footage: Footage) -> None:
    whole = sensor(footage)
    judged = whole.judged(whole.recorded)
    assert 0 < judged.sum() < judged.size
    run = whole.events(CAMERA, 0)
    assert whole.judged(run).size == run.size
    assert whole.remains(CAMERA, steps=0).told.events[0] == judged.sum()


@pytest.mark.parametrize(("gain", "larger", "events", "told"), [
    (0.004, 0.0, 400, True), (0.002, 0.0, 400, False), (0.001, 0.0, 60_000, True),
    (0.0005, 0.0, 60_000, False), (0.004, 0.001, 400, False), (0.0065, 0.001, 400, True),
])  # fmt: skip
def test_a_kind_is_told_for_three_millinats_or_for_36_nats_of_all_events(
    gain: float, larger: float, events: int, told: bool
) -> None:
    """Beyond three times what larger errors of the light leave: so much in one of twenty recordings."""
    none = np.zeros((2, 1))
    step = Telling(COVARIATES[0], gain, none, none)
    alike = ToldApart(0.0, {}, (step,), (events, events))
    open_ = LeftOpen((ToldApart(0.0, {}, (), (1, 1)),), (ToldApart(larger, {}, (), (1, 1)),))
    look = Look(1, 1, FrameLight(np.zeros((2, 1, 1), np.uint8), np.arange(2)), none[0], none[0])
    assert bool(Remains(alike, look, open_).telling) == told
