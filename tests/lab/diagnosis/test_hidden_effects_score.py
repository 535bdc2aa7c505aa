"""How verdicts on the hidden-effects grid are scored, of verdicts that are made by hand."""

import pytest
from tests.generator import UNLISTED
from tests.hidden_effects.ask import Named, Verdict
from tests.hidden_effects.cases import REPORTED_FROM
from tests.hidden_effects.page import page
from tests.hidden_effects.run import Line
from tests.hidden_effects.score import (
    DRIFTS,
    KINDS,
    WITHOUT_CONTROLS,
    controls,
    half_is_removed,
    interval,
    judge,
    judged,
    kind_is_right,
    share_removed,
    table,
)

from voltcam_lab.diagnosis.outcome.result import IntervalEstimate

from .made_answers import FLICKER, GRID, ONE, OTHER, PAIR, THIRD, answered, as_asked, named, row, said


@pytest.mark.parametrize(
    ("case", "verdict", "outcome"),
    [
        (FLICKER, said("flicker"), "right"),
        (FLICKER, said("flicker", "flicker"), "right"),
        (FLICKER, said("flicker", "latency"), "wrong"),
        (FLICKER, said("latency"), "wrong"),
        (FLICKER, said(Named(name="latency", rivals=("flicker",))), "abstained"),
        (FLICKER, said(verdict="unknown"), "abstained"),
        (FLICKER, said(verdict="none"), "abstained"),
        (FLICKER, None, "crashed"),
        ("nulls/0", said(verdict="none"), "right"),
        ("nulls/0", said(verdict="unknown"), "wrong"),
        ("slow nulls/0", said("flicker"), "wrong"),
        (PAIR, said(ONE, OTHER), "right"),
        (PAIR, said(OTHER), "abstained"),
        (PAIR, said(ONE, OTHER, THIRD), "wrong"),
        ("unlisted/rebound/strong/0", said(verdict="unknown"), "right"),
        ("unlisted/rebound/strong/0", said(verdict="none"), "abstained"),
        ("unlisted/rebound/strong/0", said("reset_noise"), "wrong"),
        ("unlisted/dim_refractory/strong/0", said("refractory_period"), "right"),
        ("unlisted/dim_refractory/strong/0", said(verdict="unknown"), "right"),
        ("further/clock_offset/strong/0", said("latency"), "right"),
        ("misspecified/gamma/0", said("input_response"), "right"),
        ("misspecified/gamma/0", said("exposure_blur"), "wrong"),
        ("misspecified/clipping/0", said("input_response"), "wrong"),
        ("misspecified/clipping/0", said(verdict="unknown"), "right"),
        ("deleted/flicker", said(verdict="unknown"), "right"),
        ("deleted/flicker", said("latency"), "wrong"),
        ("shuffled/0", said(verdict="none"), "abstained"),
        ("shuffled/0", said(verdict="refused"), "right"),
        ("nulls/0", said(verdict="refused"), "wrong"),
        (FLICKER, said(verdict="refused"), "abstained"),
        ("makes/esim", said(verdict="none"), "right"),
        ("makes/esim", said("threshold_mismatch"), "wrong"),
        ("makes/v2e, noisy", said("threshold_mismatch"), "right"),
        ("makes/v2e, noisy", said("threshold_mismatch", "latency"), "wrong"),
        ("makes/v2e, noisy", said(verdict="unknown"), "right"),
        ("makes/v2e, noisy", said(verdict="none"), "abstained"),
    ],
)
def test_outcome_of_a_verdict(case: str, verdict: Verdict | None, outcome: str) -> None:
    assert judge(named(case), Line(case=case, verdict=verdict)).outcome == outcome


def test_share_of_the_removable_gap() -> None:
    """From 1.5 to .6 where chance leaves .5."""
    assert share_removed(said("flicker", gap=0.6)) == pytest.approx(0.9)
    assert share_removed(said("flicker", gap=1.7)) == pytest.approx(-0.2)


def test_kind_of_an_unlisted_effect() -> None:
    """What tells most counts; a drift is said as one."""
    verdict = Verdict(verdict="unknown", kinds=("row", "own past"))
    assert kind_is_right("row_shadow", verdict)
    assert not kind_is_right("rebound", verdict)
    assert not kind_is_right("rebound", Verdict(verdict="unknown"))
    assert not kind_is_right("root_drift", verdict)
    assert kind_is_right("root_drift", Verdict(verdict="unknown", formula="drift += 1"))
    assert set(KINDS) | set(DRIFTS) == set(UNLISTED)


@pytest.mark.parametrize(
    ("before", "after", "half"), [(0.02, 0.009, True), (0.02, 0.011, False), (0.02, None, False)]
)
def test_half_in_nats(before: float, after: float | None, half: bool) -> None:
    assert half_is_removed(Verdict(verdict="unknown", nats_before=before, nats_after=after)) == half


def test_half_of_a_gap_is_less_than_chance() -> None:
    """From 1.5 to 1.1 where chance leaves .5 are two fifths; to .9, three."""
    less, more = (
        Verdict(verdict="unknown", gap_after=1.5, gap_floor=0.5, gap_with_formula=left) for left in (1.1, 0.9)
    )
    assert (half_is_removed(less), half_is_removed(more)) == (False, True)


def test_rivals_beside_the_name_are_told() -> None:
    set_of_two = Named(name="flicker", rivals=("latency",))
    lines = [answered(named(FLICKER), set_of_two), answered(named("singles/flicker/weak/0"), "flicker")]
    assert row(table(judged(GRID, lines)), "of those named").reached == "1 of 2: 50%"


def test_size_is_compared_in_the_registrys_terms() -> None:
    """30 Hz at 128 DN, growing with L + 20, is 55.7 Hz at 255 DN; a ratio has its thresholds' ends."""
    cutoff = Named(
        name="photoreceptor_bandwidth", parameters={"cutoff_hz": IntervalEstimate(value=60, low=50, high=70)}
    )
    case = named("singles/photoreceptor_bandwidth/strong/0")
    size = judge(case, answered(case, cutoff)).size
    assert size is not None
    assert size.true == pytest.approx(30 * 275 / 148)
    assert (size.low, size.value) == (50, 60)
    on, off = (
        IntervalEstimate(value=1.1, low=1.05, high=1.15),
        IntervalEstimate(value=0.9, low=0.85, high=0.95),
    )
    case = named("singles/comparator/weak/0")
    both = answered(case, Named(name="comparator", parameters={"theta_on": on, "theta_off": off}))
    size = judge(case, both).size
    assert size is not None
    assert (size.low, size.high) == pytest.approx((1.05 / 0.95, 1.15 / 0.85))
    assert size.true == pytest.approx(1.05) or size.true == pytest.approx(1 / 1.05)


def test_interval_is_clopper_and_pearsons() -> None:
    """Closed form where all or none."""
    assert interval(20, 20) == pytest.approx((0.025 ** (1 / 20), 1))
    assert interval(0, 48) == pytest.approx((0, 1 - 0.025 ** (1 / 48)))


@pytest.fixture(scope="module")
def right() -> list[Line]:
    return [as_asked(case) for case in GRID]


def test_all_right_meets_every_figure(right: list[Line]) -> None:
    found = judged(GRID, right)
    figures = table(found)
    told = {one.what: one.met for one in figures}
    coverage = told.pop("90% intervals that cover")
    for nothing_asked in ("of those named, with rivals beside it", WITHOUT_CONTROLS):
        assert told.pop(nothing_asked) is None
    assert all(told.values()), told
    assert coverage is False  # 9 of 9 are too many for intervals of 90 %
    assert row(figures, "parameter error").reached == "10%"
    assert row(figures, "time on two cores").reached == "54 s"
    assert all(one.reached.endswith(("100%", "0%")) for one in controls(found))


def test_a_crash_is_wrong_everywhere() -> None:
    lines = [Line(case=case.name, error="ValueError: no |\n luck") for case in GRID]
    found = judged(GRID, lines)
    figures = table(found)
    for what in ("p-values", "named, strong", "wrong name", "alarm", "the same", "unlisted", "two effects"):
        assert row(figures, what).met is False
    text = page(GRID, lines, REPORTED_FROM)
    assert text.count("ValueError: no / luck") == len(GRID)


def test_few_cases_tell_nothing_about_chance() -> None:
    case = named("nulls/0")
    figures = table(judged(GRID, [answered(case, verdict="none")]))
    assert row(figures, "alarm").met is None
    assert row(figures, "p-values").met is None
    assert row(figures, "named, strong").reached == "not run"


def test_p_values_that_crowd_are_told() -> None:
    nulls = [case for case in GRID if case.part == "nulls"]
    lines = [answered(case, verdict="none", p_value=0.5 * n / len(nulls)) for n, case in enumerate(nulls)]
    assert row(table(judged(GRID, lines)), "p-values").met is False
