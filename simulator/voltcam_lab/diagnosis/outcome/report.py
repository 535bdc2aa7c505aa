"""DIR/report.html: the diagnosis as a page that stands alone."""

from collections.abc import Sequence

from markupsafe import Markup

from ...pages.dependence import functions
from ...pages.page import figure, render, table
from ...statistics import COUNTS, LABELS, Setting, Values
from ..catalogue.entries import in_words
from ..search.identify import Identifiability, mixed_up, percent, short, smallest
from ..search.loop import Diagnosis
from ..search.state import Search
from ..session import Session
from . import figures_events, figures_statistics
from .result import FoundEffect, IntervalEstimate, Result
from .where import Ranked, View, gaps_by_group, label_in_words, numbers, ranked, views

_TONE = {"effects": "warn", "none": "good", "unknown": "bad"}
_HEADLINE = {
    "effects": "Missing: {}",
    "none": "Nothing is missing",
    "unknown": "Something unknown is missing",
}


def page_of(
    session: Session, search: Search, identifiability: Identifiability, diagnosis: Diagnosis, result: Result
) -> str:
    """The page. A few runs more are made for what is drawn from events."""
    models = views(search, diagnosis)
    return render(
        "diagnosis.html",
        title=f"Diagnosis of {session.name}",
        subtitle=f"against the camera file {session.camera.name}: {session.looked_at()}",
        tone=_TONE[result.verdict],
        headline=_HEADLINE[result.verdict].format(
            ", ".join(dict.fromkeys(in_words(one.name) for one in result.effects))
        ),
        sentence=result.sentence,
        cards=_cards(result),
        gaps=_gaps(diagnosis),
        effects=_effects(result.effects),
        advice=[one for one in result.effects if one.next_recording],
        tested=_tested(diagnosis),
        overview=_overview(search.data, models),
        remains=_remains(diagnosis),
        figures=[
            *_from_statistics(session.rig.setting, search.data, models),
            *_from_events(session, search, models),
        ],
        base=_base(identifiability, diagnosis),
        detectable=_detectable(identifiability),
        health=[finding.words for finding in session.health.findings if finding.severity != "good"],
        result=result,
        in_words=in_words,
    )


def _cards(result: Result) -> list[tuple[str, str, str]]:
    """(figure, what it is, remark): what is seen first."""
    before, after, floor = result.gap.before, result.gap.after, result.gap.floor
    cards = [(f"{before:.2f}", "gap before", "base parameters fitted, held-out data")]
    if before != after:
        removed = (before - after) / max(before - floor, 1e-9)
        cards += [(f"{after:.2f}", "gap after", f"{min(removed, 1):.0%} of what can be removed")]
    cards += [(f"{floor:.2f}", "floor", "what chance alone leaves")]
    if result.effects:
        least = max(one.p_value for one in result.effects)
        cards += [(_small(least), "p", "of such a gain by chance, over the whole catalogue")]
    return cards


def _remains(diagnosis: Diagnosis) -> Markup | None:
    """What still tells the recording from simulated ones, over all pixels; None where nothing does."""
    if diagnosis.remains is None or not diagnosis.remains.telling:
        return None
    caption = (
        "How many more events the camera has than the model, light allowed for: 0 is as many. Each panel is"
        " beside those before it; millinats an event, on stretches of time that had no part in the fit."
    )
    return figure(functions(diagnosis.remains.telling), caption)


def _gaps(diagnosis: Diagnosis) -> Markup:
    steps = {"camera file, base fitted": diagnosis.steps[0]}
    for one in diagnosis.found:
        name = f"+ {in_words(one.effect)}"
        steps[f"{name}, more of it" if name in steps else name] = diagnosis.after(one)
    gaps = {name: (step.held_out, step.floor_held_out) for name, step in steps.items()}
    if diagnosis.residual is not None:
        gaps["+ a term of unknown origin"] = (diagnosis.residual.trial.held_out, [*gaps.values()][-1][1])
    drawn = figures_statistics.gap_bars(gaps)
    caption = (
        "The gap between model and measurement as effects are added: mean robust deviation of a statistic,"
        " on a quarter of the recording that no fit has seen."
    )
    return figure(drawn, caption)


def _effects(effects: Sequence[FoundEffect]) -> Markup:
    rows = []
    for one in effects:
        sizes = Markup("<br>").join(f"{name} = {_interval(size)}" for name, size in one.parameters.items())
        gap = f"{one.gap_before:.2f} → {one.gap_after:.2f} ({one.gap_floor:.2f})"
        rivals = ", ".join(map(in_words, one.rivals)) or "none"
        odds = f"{one.odds:.2g} ({one.stand_ins:.1%})"
        rows.append([Markup("<b>{}</b>").format(one.name), sizes, gap, _small(one.p_value), odds, rivals])
    head = ["effect", "parameters, 90 % interval", "held-out gap (floor)", "p", "odds (stand-ins)", "rivals"]
    return table(head, rows)


def _tested(diagnosis: Diagnosis) -> Markup:
    """What else was fitted, last, and why it was not taken."""
    tried = next((step.trials for step in reversed(diagnosis.steps) if step.trials), ())
    added = [one.trial for one in diagnosis.found]
    rows = [
        [trial.candidate.effect, ", ".join(trial.candidate.names), trial.gained, trial.confirmed]
        for trial in tried
        if trial not in added
    ]
    return table(["effect", "parameters", "less gap in training", "less gap held out"], rows)


def _overview(data: Values, models: dict[str, View]) -> list[Markup]:
    found = {name: ranked(view, data) for name, view in models.items()}
    drawn = figures_statistics.deviation_dots(found)
    by_group = {name: gaps_by_group(view, data) for name, view in models.items()}
    return [
        figure(
            figures_statistics.group_gap_bars(by_group),
            "The gap by group of statistics; dark marks are what chance alone would leave.",
        ),
        figure(drawn, "Every statistic. In grey, where simulated twins of the model lie."),
        _worst(found),
    ]


def _worst(found: dict[str, Ranked]) -> Markup:
    """The strata that disagree most before, with what is left of them after."""
    first, *_, last = (*found.values(), *found.values())
    rows = []
    for i in _various(first):
        row: list[object] = [
            label_in_words(LABELS[i]), short(float(first.measured[i])), short(float(first.expected[i])),
            _difference(first, i), f"{first.z[i]:+.1f}", _small(float(first.q[i])),
        ]  # fmt: skip
        rows.append(row if first is last else [*row, f"{last.z[i]:+.1f}"])
    head = ["statistic", "measured", "model", "difference, 90 %", "z", "FDR"]
    return table(head if first is last else [*head, "z after"], rows)


def _various(found: Ranked, most: int = 12, alike: int = 3) -> list[int]:
    """The worst, but not more than a few of one name."""
    chosen: list[int] = []
    for i in found.order().tolist():
        same = [k for k in chosen if (LABELS[k].group, LABELS[k].name) == (LABELS[i].group, LABELS[i].name)]
        if len(same) < alike:
            chosen.append(i)
        if len(chosen) == most:
            break
    return chosen


def _difference(found: Ranked, i: int) -> str:
    middle, low, high = (float(one[i]) for one in (found.difference, found.low, found.high))
    if not COUNTS[i]:
        return f"{_signed(middle)} ({_signed(low)} to {_signed(high)})"
    if middle > 1:
        return f"× {short(1 + middle)} ({short(1 + low)} to {short(1 + high)})"
    return f"{middle:+.0%} ({low:+.0%} to {high:+.0%})"


def _signed(number: float) -> str:
    return ("+" if number > 0 else "") + short(number)


def _from_statistics(setting: Setting, data: Values, models: dict[str, View]) -> list[tuple[str, Markup]]:
    series = {"measured": numbers(data).sum(axis=0)}
    series |= {name: numbers(view.expected).sum(axis=0) for name, view in models.items()}
    return [
        ("Rates by brightness and speed", figure(
            figures_statistics.rate_maps(series, setting),
            "Measured, events per pixel and second, where light is known between frames;"
            " models as a multiple: blue too few, red too many.")),
        ("Intervals", figure(
            figures_statistics.inter_event_histograms(series), "Time between two events of a pixel.")),
        ("Response in time", figure(
            figures_statistics.lag_response_curves(series),
            "How much ln L had changed in each span before an event. What comes late has it further back.")),
    ]  # fmt: skip


def _from_events(session: Session, search: Search, models: dict[str, View]) -> list[tuple[str, Markup]]:
    rig, runs_of = session.rig, search.settings.runs
    streams = {"measured": [rig.in_trusted_light(session.recording.events)]}
    for name, view in models.items():
        runs = rig.events(view.hypothesis.parameters(), runs_of.twins[: runs_of.figures])
        streams[name] = [rig.in_trusted_light(run) for run in runs]
    setting = rig.setting
    return [
        ("Pixels", figure(
            figures_events.pixel_maps(streams, setting),
            "Events per pixel, and how many spreads of chance a run is off: blue too few, red too many.")),
        ("Spectrum", figure(
            figures_events.spectrum_curves(streams, setting),
            "Lamps on the mains make lines at 100 or 120 Hz; dotted: the mains and twice that.")),
        ("Phase of the frame, and row scan", figure(
            figures_events.frame_phase_histograms(streams, setting),
            "Events that the camera's own frames make stand at one phase, or run down the rows.")),
    ]  # fmt: skip


def _base(identifiability: Identifiability, diagnosis: Diagnosis) -> Markup:
    parameters = diagnosis.hypothesis.parameters()
    rows = [
        [
            f"{one.effect}.{one.name}", short(one.value),
            short(getattr(getattr(parameters, one.effect), one.name)), f"± {percent(one.sd)}", one.answer,
            mixed_up(one) or "–",
        ]
        for one in identifiability.base
    ]  # fmt: skip
    return table(["parameter", "camera file", "fitted", "known to", "fixed", "mixed up with"], rows)


def _detectable(identifiability: Identifiability) -> list[Markup]:
    """In two columns."""
    rows = [[f"{one.effect}.{one.name}", smallest(one)] for one in identifiability.effects]
    half = -(-len(rows) // 2)
    return [table(["effect", "seen from"], part) for part in (rows[:half], rows[half:]) if part]


def _interval(one: IntervalEstimate) -> str:
    return f"{short(one.value)} ({short(one.low)} to {short(one.high)})"


def _small(p: float) -> str:
    return f"{p:.2g}" if p >= 1e-6 else "< 10⁻⁶"
