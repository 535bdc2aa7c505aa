"""Verdicts against answers: what was asked, what was reached."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binom, binomtest, kstest

from .ask import Verdict
from .cases import Case, drawn
from .makes import MAKES
from .run import Line
from .sizes import Size, size_of

Outcome = Literal["right", "abstained", "wrong", "crashed"]
Meets = Callable[[float], bool]

FAULT_NAMES = {"gamma": "input_response", "black_level": "input_response", "exposure_blur": "exposure_blur"}
DRIFTS = ("dark_drift", "root_drift", "column_drift")
KINDS = {
    "rebound": ("own past",),
    "tiring_threshold": ("own past",),
    "after_events": ("own past",),
    "dim_refractory": ("own past",),
    "threshold_ripple": ("clock", "slow time"),
    "row_shadow": ("row", "neighbours"),
    "slew_limit": ("light", "own past"),
    "striped_thresholds": ("pixel", "row", "column"),
}  # of unlisted effects: on what firing depends that a model without them does not know
NULLS_ASKED, SLOW_NULLS_ASKED = 100, 50  # fewer recordings without an effect prove nothing


@dataclass(frozen=True)
class Judged:
    """A verdict beside its answer.

    right: each hidden effect's name and no other; "none" where nothing is hidden; "unknown" for what is not
    in the catalogue, or the listed effect that it is a form of; of another make some of what it shares with
    that, or "unknown". wrong: a name that is not hidden, an alarm where nothing is. abstained: neither, or
    refused as a bad recording, which is right only for a shuffled polarity. An effect given as a set that its
    name is in is not named, and not wrong.
    """

    case: Case
    line: Line
    outcome: Outcome
    names: tuple[str, ...]  # those given
    size: Size | None = None  # of a single effect that was named


@dataclass(frozen=True)
class Figure:
    """A row of the table. met: None where there are too few cases to tell, or nothing is asked."""

    what: str
    asked: str
    reached: str
    interval: str
    n: int
    met: bool | None


def judged(cases: Sequence[Case], lines: Sequence[Line]) -> list[Judged]:
    """The answers are drawn here, for cases with a verdict."""
    by_name = {line.case: line for line in lines}
    return [judge(case, by_name[case.name]) for case in cases if case.name in by_name]


def judge(case: Case, line: Line) -> Judged:
    """One verdict."""
    if line.verdict is None:
        return Judged(case, line, "crashed", ())
    names = tuple(dict.fromkeys(one.name for one in line.verdict.effects))
    found = Judged(case, line, _outcome(case, line.verdict), names)
    if case.part == "singles" and found.outcome == "right":
        return replace(found, size=size_of(drawn(case).effects[0], line.verdict.effects))
    return found


def hidden(case: Case) -> tuple[str, ...]:
    """Names in the registry of what is hidden and listed."""
    if case.fault:
        return (FAULT_NAMES[case.fault],) if case.fault in FAULT_NAMES else ()
    if case.sabotage == "deleted":
        return ()
    if case.make:
        return MAKES[case.make].shares
    names = {
        "clock_offset": "latency",
        "dim_refractory": "refractory_period",
        "striped_thresholds": "threshold_mismatch",
    }
    listed = [names.get(name, name) for name, _ in case.effects if case.part != "unlisted" or name in names]
    return tuple(listed)


def _outcome(case: Case, verdict: Verdict) -> Outcome:
    truth = hidden(case)
    if verdict.verdict == "refused" and case.sabotage == "shuffled":
        return "right"
    if any(one.name not in truth and not set(one.rivals) & set(truth) for one in verdict.effects):
        return "wrong"
    if case.part in ("nulls", "slow nulls"):
        return "right" if verdict.verdict == "none" else "wrong"
    named = {one.name for one in verdict.effects}
    if case.make:
        silent = not truth and verdict.verdict == "none"
        return "right" if named & set(truth) or verdict.verdict == "unknown" or silent else "abstained"
    if named and named == set(truth):
        return "right"
    may_be_unknown = case.fault or case.sabotage in ("deleted", "shuffled") or case.part == "unlisted"
    return "right" if may_be_unknown and verdict.verdict == "unknown" and not named else "abstained"


def share_removed(verdict: Verdict) -> float:
    """Of the held-out gap that is beyond chance."""
    removable = verdict.gap_before - verdict.gap_floor
    return (verdict.gap_before - verdict.gap_after) / removable if removable > 0 else float("nan")


def kind_is_right(effect: str, verdict: Verdict) -> bool:
    """Of an unlisted effect: whether the kind that tells most is its own; of a drift, whether it is said as
    one."""
    if effect in DRIFTS:
        return verdict.formula.startswith("drift")
    return verdict.kinds[:1] != () and verdict.kinds[0] in KINDS[effect]


def half_is_removed(verdict: Verdict) -> bool:
    """Whether a term without a name removes half of what could be removed on held-out data, of the gap or in
    nats an event."""
    by_gap = by_nats = 0.0
    if verdict.gap_with_formula is not None and verdict.gap_after > verdict.gap_floor:
        by_gap = (verdict.gap_after - verdict.gap_with_formula) / (verdict.gap_after - verdict.gap_floor)
    if verdict.nats_before is not None and verdict.nats_after is not None and verdict.nats_before > 0:
        by_nats = 1 - verdict.nats_after / verdict.nats_before
    return max(by_gap, by_nats) >= 0.5


def table(found: Sequence[Judged]) -> list[Figure]:
    """All rows."""
    part = {name: [one for one in found if one.case.part == name] for name in {j.case.part for j in found}}
    singles, unlisted, pairs = (part.get(name, []) for name in ("singles", "unlisted", "pairs"))
    nulls, slow = part.get("nulls", []), part.get("slow nulls", [])
    named = [one for one in singles if one.outcome == "right"]
    nameless = [
        (one.case.effects[0][0], one.line.verdict or Verdict(verdict="refused"))
        for one in unlisted
        if not (one.outcome == "right" and one.names)
    ]  # not those that are a form of a listed effect, and were named as that
    bad: tuple[Outcome, ...] = ("wrong", "crashed")
    rows = [
        _rate(f"named, {level}", _are(_level(singles, level), "right"), least=asked)
        for level, asked in (("strong", 0.95), ("medium", 0.85), ("weak", 0.60))
    ]
    rows += [
        _rate("of those named, with rivals beside it", [_has_rivals(one) for one in named]),
        _rate("wrong name", _are(singles, *bad), most=0.02),
        _rate("alarm without an effect", _are(nulls, *bad), most=0.05, n_asked=NULLS_ASKED),
        _rate("the same, 25 to 40 fps", _are(slow, *bad), most=0.10, n_asked=SLOW_NULLS_ASKED),
        _rate(
            'unlisted effect called "unknown", or what it is a form of', _are(unlisted, "right"), least=0.90
        ),
        _rate("unlisted effect given a wrong name", _are(unlisted, *bad), most=0.05),
        _rate("unlisted effect: kind told rightly", [kind_is_right(*one) for one in nameless], least=0.70),
        _rate(
            "unlisted effect: half of it removed by a term without a name",
            [half_is_removed(verdict) for _, verdict in nameless],
            least=0.60,
        ),
        _rate("two effects: both named", _are(pairs, "right"), least=0.60),
        _rate("two effects: no wrong one", _are(pairs, "right", "abstained"), least=0.95),
        *_shares(named),
        *_sizes([one.size for one in singles if one.size]),
        _uniform([one.line.verdict.p_value if one.line.verdict else 0.0 for one in nulls]),
        _time(found),
        replace(
            _time([*singles, *nulls, *slow, *unlisted, *pairs]), what=WITHOUT_CONTROLS, asked="", met=None
        ),
    ]
    return rows


def controls(found: Sequence[Judged]) -> list[Figure]:
    """Rows of what section 5 asks no figure for."""
    words = {
        "misspecified": "frames misspecified: input effect named, or unknown",
        "deleted": "true effect deleted from the catalogue: unknown",
        "shuffled": "polarity shuffled: unknown, or refused as a bad recording",
        "further": "other effects of the catalogue: named",
        "makes": "recordings of other makes: effects that they share named, or unknown",
    }
    rows = []
    for name, what in words.items():
        part = [one for one in found if one.case.part == name]
        rows.append(_rate(what, _are(part, "right")))
        rows.append(_rate(f"{name}: wrong name", _are(part, "wrong", "crashed")))
    return rows


def interval(k: int, n: int) -> tuple[float, float]:
    """Clopper and Pearson's, 95 %."""
    found = binomtest(k, n).proportion_ci(0.95, "exact")
    return float(found.low), float(found.high)


def _level(singles: Sequence[Judged], level: str) -> list[Judged]:
    return [one for one in singles if one.case.effects[0][1] == level]


def _are(part: Sequence[Judged], *outcomes: Outcome) -> list[bool]:
    return [one.outcome in outcomes for one in part]


def _has_rivals(one: Judged) -> bool:
    return bool(one.line.verdict and any(effect.rivals for effect in one.line.verdict.effects))


def _rate(
    what: str, hits: Sequence[bool], least: float | None = None, most: float | None = None, n_asked: int = 1
) -> Figure:
    limits = [f"at least {least:.0%}"] if least is not None else []
    limits += [f"at most {most:.0%}"] if most is not None else []
    asked = ", ".join(limits) + (f" of {n_asked} or more" if n_asked > 1 else "")
    k, n = sum(hits), len(hits)
    if not n:
        return Figure(what, asked, "not run", "", 0, None)
    low, high = interval(k, n)
    met = (least or 0) <= k / n <= (1 if most is None else most) if limits and n >= n_asked else None
    return Figure(what, asked, f"{k} of {n}: {k / n:.0%}", f"{low:.0%} to {high:.0%}", n, met)


def _shares(named: Sequence[Judged]) -> list[Figure]:
    shares = np.array([share_removed(one.line.verdict) for one in named if one.line.verdict])
    shares = shares[np.isfinite(shares)]
    what = "share of the removable held-out gap removed, when named"
    worst = f"{shares.min():.2f}" if shares.size else "not run"
    return [
        _median(f"{what}: median", "at least 0.90", shares, "{:.2f}", lambda middle: middle >= 0.90),
        Figure(
            f"{what}: worst", "at least 0.60", worst, "", shares.size,
            bool(shares.min() >= 0.60) if shares.size else None,
        ),
    ]  # fmt: skip


def _sizes(sizes: Sequence[Size]) -> list[Figure]:
    errors = np.array([abs(size.value / size.true - 1) for size in sizes])
    covered = [size.low <= size.true <= size.high for size in sizes]
    return [
        _median("parameter error: median", "at most 15%", errors, "{:.0%}", lambda middle: middle <= 0.15),
        _rate("90% intervals that cover", covered, least=0.80, most=0.97),
    ]


def _uniform(p_values: Sequence[float]) -> Figure:
    what, asked = "p-values without an effect", f"uniform: KS p > 0.01, n >= {NULLS_ASKED}"
    if not p_values:
        return Figure(what, asked, "not run", "", 0, None)
    p = float(kstest(p_values, "uniform").pvalue)
    met = p > 0.01 if len(p_values) >= NULLS_ASKED else None
    return Figure(what, asked, f"KS p = {p:.2g}", "", len(p_values), met)


TWO_CORES, BESIDE_S = 0.64, 22.0
"""Time on two cores of that on one: `voltcam diagnose` took 67.5 s of a null, not 105.6; of a dead time 78,
not 131. And what it takes there beside the search, to begin, to say what a recording can tell, and to draw
the page: three nulls took 42.9, 47.9 and 35.7 s, of 25.5, 38.4 and 31.9 s on one core to the verdict."""
WITHOUT_CONTROLS = "without the cases of the next table: median"


def _time(found: Sequence[Judged]) -> Figure:
    cpu_s = [one.line.cpu_s for one in found if one.line.verdict and one.line.verdict.verdict != "refused"]
    shares = f"{TWO_CORES} of the search's on one, and {BESIDE_S:g} s"
    what = f"time on two cores, 48 x 36 ({shares}): median"
    times_s = TWO_CORES * np.array(cpu_s) + BESIDE_S if cpu_s else np.empty(0)
    return _median(what, "60 s", times_s, "{:.0f} s", lambda middle: middle <= 60)


def _median(what: str, asked: str, values: NDArray[np.float64], form: str, meets: Meets) -> Figure:
    """With the interval between order statistics that holds the median in 95 % of cases."""
    if not values.size:
        return Figure(what, asked, "not run", "", 0, None)
    middle, ordered, n = float(np.median(values)), np.sort(values), values.size
    first = int(binom.ppf(0.025, n, 0.5))
    ends = ""
    if first > 0:
        ends = f"{form.format(ordered[first - 1])} to {form.format(ordered[n - first])}"
    return Figure(what, asked, form.format(middle), ends, n, meets(middle))
