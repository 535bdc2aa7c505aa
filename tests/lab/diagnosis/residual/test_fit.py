"""A generic term takes away what was hidden by code that shares nothing with the simulator."""

from dataclasses import replace

import numpy as np
from tests.generator import Base, draw_base, draw_effect, draw_scene, record

from voltcam_client.formats import Recording
from voltcam_lab.diagnosis.residual.fit import generic_terms
from voltcam_lab.diagnosis.rig.settings import DEFAULT_RECORDING, DEFAULT_RIG
from voltcam_lab.diagnosis.rig.whole import NOTICEABLE, WholeSensor
from voltcam_lab.diagnosis.session import whole_sensor
from voltcam_lab.models.exact import K1_TO_K6
from voltcam_lab.recordings import with_frames
from voltcam_simulator import Parameters


def true_camera(base: Base) -> Parameters:
    changes: dict[str, dict[str, float]] = {
        "comparator": {"theta_on": base.theta_on, "theta_off": base.theta_off}
    }
    for (effect, name), value in zip(
        K1_TO_K6.values(), (base.k1, base.k2, base.k3, base.k4, base.k5, base.k6), strict=True
    ):
        changes.setdefault(effect, {})[name] = value
    return Parameters().changed(changes)


def hidden(name: str | None) -> tuple[WholeSensor, Parameters]:
    rng = np.random.default_rng(21)
    scene, base = draw_scene(rng, 32, 24, 4.0), draw_base(rng, asymmetry=0.0, camera="davis346")
    effects = [draw_effect(rng, name, "strong")] if name else []
    made = record(scene, base, effects, seconds=4.0, seed=5)
    recording = Recording(made.events, 32, 24, made.frames, made.frame_t_us)
    footage = with_frames(recording)
    rig = replace(DEFAULT_RIG, versions=2)
    return whole_sensor(footage, DEFAULT_RECORDING, rig, 0), true_camera(base)


def test_what_follows_events_is_found_as_a_kick_that_takes_half_of_it_away() -> None:
    """A quarter of the events is followed by another of its kind, .2 to 1.5 ms later in the mean."""
    sensor, camera = hidden("after_events")
    said: list[str] = []
    terms = generic_terms(sensor, camera, sensor.remains(camera), said.append)
    first = terms[0]
    assert (first.shape.kind, first.shape.effect) == ("own past", "residual_kick")
    kick = first.parameters.residual_kick
    assert kick.after_on > 0 > kick.after_off
    assert 0.1 < kick.chance < 0.5
    assert 50 < kick.delay_us < 2000
    assert first.before.noticed > 5 * NOTICEABLE
    assert first.share > 0.5
    assert first.shape.formula() in said[1]


def test_thresholds_that_go_with_the_place_are_found_as_a_pattern_that_takes_half_of_it_away() -> None:
    """Thresholds of rows, six by six, are 1.3 and 0.7 times as high: not a wave, but near one."""
    sensor, camera = hidden("striped_thresholds")
    terms = generic_terms(sensor, camera, sensor.remains(camera), lambda said: None)
    found = next(one for one in terms if one.shape.effect == "residual_pattern")
    pattern = found.parameters.residual_pattern
    assert 0.15 < max(abs(pattern.on), abs(pattern.off)) < 0.6
    assert found.before.noticed > 5 * NOTICEABLE
    assert found.share > 0.5


def test_where_nothing_is_hidden_no_term_is_looked_for() -> None:
    sensor, camera = hidden(None)
    said: list[str] = []
    assert generic_terms(sensor, camera, sensor.remains(camera), said.append) == ()
    assert said == []


def test_no_term_is_kept_where_the_later_part_has_too_few_events_to_judge_it() -> None:
    """All events of the later part are taken away but a hundred, and no light is known less well for that."""
    sensor, camera = hidden("after_events")
    events = sensor.footage.events
    last = int(np.flatnonzero(events["t"] > 2.4e6)[0]) + 100
    fewer = replace(sensor.footage, events=events[:last])
    sensor = whole_sensor(fewer, DEFAULT_RECORDING, replace(DEFAULT_RIG, versions=2), 0)
    said: list[str] = []
    assert generic_terms(sensor, camera, sensor.remains(camera), said.append) == ()
    assert "None can be judged" in said[-1]
