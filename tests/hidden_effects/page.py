"""docs/how-it-works/hidden-effects.md: the grid's outcome, whatever it is."""

from collections import Counter
from collections.abc import Iterable, Sequence

import numpy as np
from tests.generator import FAULTS, UNLISTED

from .ask import Verdict
from .cases import ANY_FPS, FPS, FURTHER, HEIGHT, REPORTED_FROM, SECONDS, SINGLES, SLOW_FPS, WIDTH, Case
from .makes import MAKES
from .run import Line
from .score import Figure, Judged, controls, judged, share_removed, table

LEVELS = ("strong", "medium", "weak")
_ANSWERS = ("none", "unknown", "refused", "crashed")


def page(cases: Sequence[Case], lines: Sequence[Line], seed: int) -> str:
    """Markdown, of all cases that have a verdict."""
    found = judged(cases, lines)
    sections = [
        _head(cases, found, seed),
        _section("What was asked, and what was reached", _figures(table(found)), _TABLE),
        _section("Controls", _figures(controls(found)), _CONTROLS),
        _section("Effect by effect", _by_effect(found), _BY_EFFECT),
        _section("Unlisted effects", _unlisted(found), _UNLISTED),
        _section("Other makes", _makes(found), _MAKES),
        _section("Who was taken for whom", _confusion(found), _CONFUSION),
        _section("Wrong answers, refusals and crashes", _wrong(found), _WRONG),
    ]
    return "\n\n".join(sections) + "\n"


_TABLE = """\
Intervals: 95 %, Clopper and Pearson's for shares, between order statistics for medians. Met or not goes by
the figure, not by its interval. A case that crashed counts as wrong. A diagnosis that gives a set of effects
which explain a recording equally well, with the true one in it but not first, has not named it, and has not
named a wrong one."""
_CONTROLS = "No figure was asked for here. A crash counts as a wrong name."
_BY_EFFECT = """\
Named of how many, by level; median of the share of the removable held-out gap that was removed, and of the
size found over the hidden one, where named."""
_UNLISTED = """\
The formula is that of the generic term which the diagnosis added, where it did, with the gap on held-out data
before and after it, and the floor; "unknown" stays the verdict. The names are those of
`tests/generator/unlisted.py`."""
_MAKES = """\
The pixels of ESIM and v2e as their papers have them, on scenes of the generator; the camera file has their
thresholds and nothing else. Gaps are on held-out data."""
_CONFUSION = """\
Rows are what was hidden, columns what was answered, by the letters of the rows; a verdict of two names counts
twice. Pairs, sabotaged recordings and other makes are left out."""
_WRONG = "Refusals are those of recordings that are not bad. Each can be made again from its seed."


def _head(cases: Sequence[Case], found: Sequence[Judged], seed: int) -> str:
    first, last = cases[0].seed, cases[-1].seed
    reported = seed >= REPORTED_FROM
    use = (
        "the report's; development has those below" if reported else "for development; the report's begin at"
    )
    versions = Counter(one.line.code for one in found)
    code = ", ".join(f"{name} ({n})" for name, n in versions.most_common())
    mixed = " Verdicts come from more than one version of it." if len(versions) > 1 else ""
    left = f" **Not finished: {len(found)} of {len(cases)} cases have run.**"
    part = left if len(found) < len(cases) else ""
    return f"""# Hidden effects

Written by `make hidden-effects`; not by hand.{part}

Each case is a recording of {SECONDS:g} s and {WIDTH} x {HEIGHT} pixels, on a scene of its own. It is made by
`tests/generator`, which shares no code with simulator and lab and forms effects in its own way. Every base
parameter is off by up to 30 %. Other makes have the lab's baselines for pixels.

Half of the scenes are six plane waves of 6 to 26 pixels that never rest. The others are photographs that turn
and zoom behind others that fly by. Frames are of 8 bit. Nulls have {FPS:g} of them a second, slow nulls
{SLOW_FPS[0]:g} to {SLOW_FPS[1]:g}, all others {ANY_FPS[0]:g} to {ANY_FPS[1]:g}.

The diagnosis gets events, frames and the published parameters of the camera, on one thread. Its verdict is on
disk before the answer is drawn from the seed.
Seeds are {first} to {last}, {use} {REPORTED_FROM}.
What is asked was written down before the first case ran.

Sources of simulator, lab, generator and light between frames (digest, verdicts):
{code or "none yet"}.{mixed}"""


def _section(title: str, body: str, words: str) -> str:
    return f"## {title}\n\n{words}\n\n{body}"


def _grid(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _figures(figures: Sequence[Figure]) -> str:
    rows = [(one.what, one.asked, one.reached, one.interval, str(one.n), _met(one)) for one in figures]
    return _grid(("", "asked", "reached", "interval", "n", ""), rows)


def _met(one: Figure) -> str:
    if one.met is None:
        return "too few" if one.asked and one.n else ""
    return "met" if one.met else "**not met**"


def _by_effect(found: Sequence[Judged]) -> str:
    rows = []
    for effect in SINGLES:
        of = [one for one in found if one.case.part == "singles" and one.case.effects[0][0] == effect]
        cells = []
        for level in LEVELS:
            at = [one.outcome == "right" for one in of if one.case.effects[0][1] == level]
            cells.append(f"{sum(at)} of {len(at)}" if at else "")
        named = [one for one in of if one.outcome == "right"]
        shares = [share_removed(one.line.verdict) for one in named if one.line.verdict]
        ratios = [one.size.value / one.size.true for one in named if one.size]
        rows.append((effect, *cells, _middle(shares), _middle(ratios)))
    return _grid(("", *LEVELS, "share removed", "size found / hidden"), rows)


def _middle(values: Sequence[float]) -> str:
    return f"{np.nanmedian(values):.2f}" if np.isfinite(values).any() else ""


def _unlisted(found: Sequence[Judged]) -> str:
    rows = []
    for effect in UNLISTED:
        of = [one for one in found if one.case.part == "unlisted" and one.case.effects[0][0] == effect]
        answers = [
            ", ".join(_answered(one) for one in of if one.case.effects[0][1] == level) for level in LEVELS[:2]
        ]
        verdicts = [one.line.verdict for one in of if one.line.verdict]
        formulas = [_formula(one) for one in verdicts if one.gap_with_formula is not None]
        rows.append((effect, *answers, ", ".join(formulas)))
    return _grid(("hidden", *LEVELS[:2], "formulas"), rows)


def _formula(verdict: Verdict) -> str:
    gaps = f"{verdict.gap_after:.2f} to {verdict.gap_with_formula:.2f}, {verdict.gap_floor:.2f}"
    return f"`{verdict.formula}` ({gaps})"


def _makes(found: Sequence[Judged]) -> str:
    rows = []
    for one in found:
        if one.case.make and (verdict := one.line.verdict):
            gaps = (f"{gap:.2f}" for gap in (verdict.gap_before, verdict.gap_after, verdict.gap_floor))
            shares = ", ".join(MAKES[one.case.make].shares)
            rows.append((one.case.make, shares, _answered(one), *gaps))
    return _grid(("make", "shares", "answer", "gap", "after", "by chance"), rows)


def _answered(one: Judged) -> str:
    if one.line.verdict is None:
        return "crashed"
    return ", ".join(one.names) or one.line.verdict.verdict


def _confusion(found: Sequence[Judged]) -> str:
    count: dict[str, Counter[str]] = {}
    for one in found:
        if one.case.part in ("pairs", "deleted", "shuffled", "makes"):
            continue
        hidden = one.case.effects[0][0] if one.case.effects else one.case.fault or "nothing"
        count.setdefault(hidden, Counter()).update(_answered(one).split(", "))
    given = {name for answers in count.values() for name in answers}
    order = (*SINGLES, *FURTHER, *UNLISTED, *FAULTS, "nothing")
    names = [name for name in order if name in count or name in given]
    names += sorted(given - {*names, *_ANSWERS})
    letters = {name: _letter(n) for n, name in enumerate(names)}
    columns = [name for name in names if name in given]
    rows = []
    for name in names:
        answers = count.get(name, Counter())
        cells = (_cell(answers[column], column == name) for column in (*columns, *_ANSWERS))
        rows.append((letters[name], name, *cells))
    return _grid(("", "hidden", *(letters[name] for name in columns), *_ANSWERS), rows)


def _letter(n: int) -> str:
    return chr(ord("a") + n) if n < 26 else "a" + _letter(n - 26)


def _cell(n: int, diagonal: bool) -> str:
    return f"**{n}**" if n and diagonal else str(n) if n else "."


def _wrong(found: Sequence[Judged]) -> str:
    rows = []
    for one in found:
        verdict = one.line.verdict
        reason = verdict.reason if verdict else one.line.error
        if one.outcome in ("wrong", "crashed") or (reason and one.outcome != "right"):
            rows.append((one.case.name, str(one.case.seed), _answered(one), _flat(reason)))
    return _grid(("case", "seed", "answer", "reason"), rows) if rows else "None."


def _flat(words: str) -> str:
    """Fit for a cell."""
    return " ".join(words.split()).replace("|", "/")
