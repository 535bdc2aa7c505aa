"""Generic terms as a sentence, in result.json and in the camera file."""

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest

from voltcam_lab.dependence.covariates import Covariate
from voltcam_lab.dependence.told_apart import Telling, ToldApart
from voltcam_lab.diagnosis.outcome.accepted import Accepted, camera_of, fitted
from voltcam_lab.diagnosis.outcome.conclude import result_of
from voltcam_lab.diagnosis.outcome.generic import generic_of, term_in_words
from voltcam_lab.diagnosis.outcome.report import page_of
from voltcam_lab.diagnosis.residual.fit import GenericTerm
from voltcam_lab.diagnosis.residual.shapes import KickShape
from voltcam_lab.diagnosis.rig.whole import NOTICEABLE, LeftOpen, Remains, WholeSensor
from voltcam_simulator import Parameters

from ..conftest import Done

SHAPE = KickShape(
    "own past", "residual_kick", {"size": 2.0, "spread_decades": 0.0}, {"chance": 0.25, "delay_us": 600.0}
)


def told(nats: float) -> ToldApart:
    return ToldApart(nats, {}, (), (1000, 1000))


def term(sensor: WholeSensor, parameters: Parameters) -> GenericTerm:
    before, after = (Remains(told(nats), sensor.look, LeftOpen((told(0.001),))) for nats in (0.08, 0.012))
    return GenericTerm(SHAPE, before, after, SHAPE.on(parameters))


def test_a_term_says_its_formula_and_what_it_takes_away(done: Done) -> None:
    one = term(done.session.sensor, Parameters.of("paper"))
    words = term_in_words(one)
    assert SHAPE.formula() in words
    assert "11.0 millinats an event are left of 79.0" in words
    record = generic_of(one)
    assert (record.name, record.kind) == ("residual_kick", "own past")
    assert record.parameters["chance"] == 0.25
    assert (record.nats_before, record.nats_after) == pytest.approx((0.079, 0.011))


def test_it_stands_in_result_page_and_camera_file_and_the_verdict_stays(done: Done) -> None:
    unknown = replace(done.diagnosis, verdict="unknown", found=(), covariance=None)
    terms = (term(done.session.sensor, unknown.hypothesis.parameters()),)
    result = result_of(done.session, done.search, done.identifiability, unknown, terms)
    assert result.verdict == "unknown"
    assert [one.name for one in result.generic] == ["residual_kick"]
    assert term_in_words(terms[0]) in result.sentence
    page = page_of(done.session, done.search, done.identifiability, unknown, result)
    assert "It is in the camera file as <code>residual_kick</code>" in page
    as_it_was = Accepted(done.session.parameters, "as it was", {"fitted": 2.0, "as it was": 1.0})
    result = result_of(done.session, done.search, done.identifiability, unknown, terms, as_it_was)
    page = page_of(done.session, done.search, done.identifiability, unknown, result)
    assert "It is in the camera file" not in page
    assert "The camera file is nearer without it." in page
    assert "the new file is the one that was given" in page
    kick = camera_of(done.session, fitted(unknown, terms)).parameters.residual_kick
    assert (kick.after_on, kick.after_off, kick.chance, kick.delay_us) == (2.0, -2.0, 0.25, 600.0)
    assert not camera_of(done.session, fitted(unknown)).parameters.residual_kick.active


@pytest.mark.parametrize("nats", [0.002, 0.05])
@pytest.mark.parametrize("verdict", ["none", "unknown"])
def test_of_what_is_unknown_the_kind_is_told_if_it_matters(
    done: Done, nats: float, verdict: Literal["none", "unknown"]
) -> None:
    clock = Covariate("clock", "clock", "way from tick to tick", 2)
    step = Telling(clock, nats, np.zeros((2, 2)), np.full((2, 2), 0.5))
    look, by_light = done.session.sensor.look, LeftOpen((told(0.0),))
    left = Remains(ToldApart(0.0, {}, (step,), (1000, 1000)), look, by_light)
    without = replace(done.diagnosis, verdict=verdict, found=(), covariance=None, remains=left)
    result = result_of(done.session, done.search, done.identifiability, without)
    page = page_of(done.session, done.search, done.identifiability, without, result)
    matters = nats > NOTICEABLE and verdict == "unknown"
    assert ("What is left by kind: " in result.sentence) == matters
    assert ("Nothing is missing: " in result.sentence) == (verdict == "none")
    assert ({"none": "Nothing is missing", "unknown": "Something unknown is missing"}[verdict]) in page
