"""Verdicts on cases of the hidden-effects grid, made by hand."""

from tests.hidden_effects.ask import Named, Verdict
from tests.hidden_effects.cases import REPORTED_FROM, SINGLES, Case, drawn, grid
from tests.hidden_effects.run import Line
from tests.hidden_effects.score import DRIFTS, KINDS, Figure

from voltcam_lab.diagnosis.outcome.result import IntervalEstimate

GRID = grid(REPORTED_FROM)


def named(name: str) -> Case:
    return next(case for case in GRID if case.name == name)


def said(*effects: str | Named, verdict: str = "", gap: float = 0.52, p_value: float = 0.5) -> Verdict:
    """Effects by name, or a verdict without any; the gap is 1.5 before and .5 by chance."""
    given = tuple(one if isinstance(one, Named) else Named(name=one) for one in effects)
    return Verdict.model_validate(
        {"verdict": "effects" if given else verdict, "effects": given, "gap_before": 1.5, "gap_after": gap,
         "gap_floor": 0.5, "p_value": p_value}
    )  # fmt: skip


def answered(
    case: Case, *effects: str | Named, verdict: str = "", gap: float = 0.52, p_value: float = 0.5
) -> Line:
    return Line(case=case.name, verdict=said(*effects, verdict=verdict, gap=gap, p_value=p_value), cpu_s=50.0)


def as_asked(case: Case) -> Line:
    """The right answer to a case."""
    if case.part == "unlisted":
        effect = case.effects[0][0]
        drift = {"formula": "drift += 1", "gap_with_formula": 0.5} if effect in DRIFTS else {}
        kind = {"kinds": KINDS.get(effect, ()), "nats_before": 0.02, "nats_after": 0.001}
        return Line(
            case=case.name,
            verdict=said(verdict="unknown", gap=1.5).model_copy(update=drift or kind),
            cpu_s=50.0,
        )
    if case.sabotage in ("deleted", "shuffled") or case.fault:
        return answered(case, verdict="unknown")
    if not case.effects:
        return answered(case, verdict="none", p_value=(case.seed * 0.618) % 1)
    estimates = {}
    if case.part == "singles" and case.effects[0][0] == "flicker":
        depth = drawn(case).effects[0].parameters["depth"]
        estimates = {"depth": IntervalEstimate(value=1.1 * depth, low=0.9 * depth, high=1.3 * depth)}
    names = ["latency" if name == "clock_offset" else name for name, _ in case.effects]
    return answered(case, Named(name=names[0], parameters=estimates), *names[1:])


def row(figures: list[Figure], beginning: str) -> Figure:
    return next(one for one in figures if one.what.startswith(beginning))


FLICKER, PAIR = "singles/flicker/strong/0", next(case.name for case in GRID if case.part == "pairs")
ONE, OTHER = (effect for effect, _ in named(PAIR).effects)
THIRD = next(effect for effect in SINGLES if effect not in (ONE, OTHER))
