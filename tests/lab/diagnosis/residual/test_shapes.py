"""A generic term's numbers, as an effect's parameters and as a formula; and where a fit begins."""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_lab.dependence.clock import RowClock
from voltcam_lab.dependence.covariates import COVARIATES, FINER, LATTICE, PAST_BINS, PHASES, Covariate
from voltcam_lab.dependence.told_apart import Telling
from voltcam_lab.diagnosis.residual.begin import beginnings, fits
from voltcam_lab.diagnosis.residual.shapes import ClockShape, KickShape, PatternShape
from voltcam_lab.diagnosis.rig.clock import counted_from
from voltcam_simulator import Parameters

SIDES = 48, 36
TEN_MS = 28
"""The bin of 10 ms: 1 + 4/0.15 decades, and one more."""


def past(name: str, off: float, on: float, at: int = TEN_MS) -> Telling:
    """Log ratios of OFF and ON events in three bins of the time since another event."""
    function = np.zeros((2, PAST_BINS))
    function[:, at - 1 : at + 2] = np.array([[off], [on]])
    covariate = next(one for one in COVARIATES if one.name == name)
    return Telling(covariate, 0.02, function, np.full((2, PAST_BINS), 0.5 / PAST_BINS))


def test_numbers_are_the_effect_s_and_stay_within_their_limits() -> None:
    shape = KickShape(
        "neighbours", "residual_coupling", {"chance": 1.0, "spread_decades": 0.2},
        {"size": 0.25, "delay_us": 3000.0}, (1, -1),
    )  # fmt: skip
    camera = shape.on(Parameters()).residual_coupling
    assert (camera.after_on, camera.after_off, camera.delay_us) == (0.25, -0.25, 3000)
    assert shape.formula() == (
        "V += +0.25 after a neighbour's ON event and -0.25 after a neighbour's OFF event, 3 ms later"
        " (times or over 1.6)"
    )
    larger, smaller = shape.moves("size", 2.0)
    assert (larger.numbers["size"], smaller.numbers["size"]) == (0.5, 0.125)
    assert shape.with_number("delay_us", 1e9).on(Parameters()).residual_coupling.delay_us == 1e6


def test_a_clock_s_phase_moves_by_a_part_of_its_period() -> None:
    shape = ClockShape(
        "clock", "residual_clock", {"period_us": 8000.0, "row_us": 12.5}, {"size": 0.1, "begin_us": 1000.0}
    )
    later, earlier = shape.moves("begin_us", 1.8)
    assert (later.numbers["begin_us"], earlier.numbers["begin_us"]) == (1800.0, 200.0)
    assert shape.on(Parameters()).residual_clock.kick == 0.1
    assert "each period of 8 ms from 1 ms + 12.5 us a row on" in shape.formula()


def test_a_clock_in_a_camera_file_is_on_the_recording_s_time_line() -> None:
    clock = {"kick": 0.1, "period_us": 7000.0, "begin_us": 500.0}
    parameters = Parameters().changed({"residual_clock": clock})
    moved = counted_from(parameters, 10_000)
    assert moved.residual_clock.begin_us == (500 - 10_000) % 7000
    assert counted_from(moved, -10_000) == parameters


@pytest.mark.parametrize(
    ("step", "signs"),
    [
        (past("own_same", 0.8, 1.0), (1, -1)),  # another of its kind follows
        (past("own_same", 0.0, 1.0), (1, 0)),
        (past("own_same", -0.9, -1.0), (-1, 1)),  # none follows
        (past("own_other", 1.0, 0.1), (-1, 0)),  # OFF follows ON
        (past("near_other", 0.1, 1.0), (0, 1)),
    ],
)
def test_a_kick_s_sign_is_that_of_the_events_that_are_too_many(step: Telling, signs: tuple[int, int]) -> None:
    found = [one.shape for one in beginnings(step, Parameters(), SIDES)]
    assert fits(step)
    assert all(isinstance(one, KickShape) and one.signs == signs for one in found)
    too_many = step.function.max() > -step.function.min()
    assert len(found) == (2 if too_many else 1)  # nothing that is set off makes events fewer
    effect = "residual_coupling" if step.covariate.kind == "neighbours" else "residual_kick"
    assert {one.effect for one in found} == {effect}
    assert 0.5e4 < found[0].numbers["delay_us"] < 2e4


def test_what_has_no_time_or_no_term_is_not_fitted() -> None:
    assert not fits(past("row", 1.0, 1.0))
    assert not fits(past("own_same", 1.0, 1.0, at=PAST_BINS - 2))  # after longer than anything: no kick


def test_a_peak_as_wide_as_it_may_be_is_within_the_effect_s_limits() -> None:
    step = past("near_other", -1.0, -1.0)
    function = np.full_like(step.function, -1.0)
    function[:, -1] = 0.0
    for one in beginnings(replace(step, function=function), Parameters(), SIDES):
        assert one.shape.on(Parameters()).residual_coupling.spread_decades == 1.0


def test_a_clock_too_steep_for_the_effect_is_not_begun_with() -> None:
    step = Telling(Covariate("clock", "clock", "", PHASES), 0.02, np.ones((2, PHASES)), np.ones((2, PHASES)))
    assert list(beginnings(step, Parameters(), SIDES, RowClock(2e5, 2e4))) == []


def test_a_clock_goes_up_where_on_events_are_too_many() -> None:
    phase = (np.arange(PHASES) + 0.5) / PHASES
    wave = 0.3 * np.cos(2 * np.pi * (phase - 0.3))
    step = Telling(
        Covariate("clock", "clock", "", PHASES), 0.02, np.stack([-wave, wave]),
        np.full((2, PHASES), 0.5 / PHASES),
    )  # fmt: skip
    found = [one.shape for one in beginnings(step, Parameters(), SIDES, RowClock(6000.0, 10.0))]
    begins = sorted(one.numbers["begin_us"] for one in found)
    assert begins == pytest.approx([1050, 1800, 2550], abs=30)
    assert all(one.fixed == {"period_us": 6000.0, "row_us": 10.0} for one in found)


def test_a_pattern_s_crest_moves_by_a_part_of_its_wave() -> None:
    shape = PatternShape(
        "pixel", "residual_pattern", {"across_per_px": 0.25, "down_per_px": 0.0},
        {"size": 0.6, "crest_turns": 0.95}, (1, -1),
    )  # fmt: skip
    assert shape.moves("size", 2.0)[0].numbers["size"] == 0.9
    assert [one.numbers["crest_turns"] for one in shape.moves("crest_turns", 1.8)] == pytest.approx(
        [0.05, 0.85]
    )
    camera = shape.on(Parameters()).residual_pattern
    assert (camera.on, camera.off, camera.across_per_px) == (0.6, -0.6, 0.25)
    assert shape.formula() == (
        "ON thresholds *= 1 +0.6 w and OFF thresholds *= 1 -0.6 w, w = cos 2 pi (+0.25 x - 0.95)"
    )


@pytest.mark.parametrize(("off", "signs"), [(0.2, (1, 1)), (0.02, (1, 0)), (-0.2, (1, -1))])
def test_thresholds_are_lower_where_events_are_too_many(off: float, signs: tuple[int, int]) -> None:
    """Columns of even number have too few ON events."""
    covariate = next(one for one in FINER if one.name == "lattice")
    wave = np.where(np.arange(LATTICE**2) % 2, 1.0, -1.0)
    function, share = np.stack([off * wave, 0.2 * wave]), np.full((2, LATTICE**2), 0.5 / LATTICE**2)
    step = Telling(covariate, 0.02, function, share)
    assert fits(step)
    found = list(beginnings(step, Parameters(), SIDES))
    camera = found[0].shape.on(Parameters()).residual_pattern
    assert (camera.across_per_px, camera.down_per_px) == (0.5, 0.0)
    at_even, at_odd = (np.cos(2 * np.pi * (turn - camera.crest_turns)) for turn in (0.0, 0.5))
    assert camera.on * at_even == pytest.approx(-camera.on * at_odd, abs=1e-6)
    assert camera.on * at_even == pytest.approx(0.2, rel=0.1)
    assert tuple(np.sign([camera.on * at_even, camera.off * at_even])) == signs
    assert found[0].values == pytest.approx((0.1, 0.2, 0.4), rel=0.1)
