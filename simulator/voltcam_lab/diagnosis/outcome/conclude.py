"""The result of a diagnosis, put together from what the search left; nothing is simulated anew."""

import platform
from collections.abc import Sequence
from importlib import metadata

import numpy as np

from ...dependence.words import sentence as kind_in_words
from ...statistics import COUNTS, LABELS
from ..catalogue.entries import in_words, next_recording
from ..residual.fit import GenericTerm
from ..search.identify import Identifiability
from ..search.left import more_than_light
from ..search.loop import Diagnosis, Found
from ..search.settings import DEFAULTS, SearchSettings
from ..search.settings_proof import Reporting
from ..search.state import Search
from ..session import Session
from .accepted import Accepted
from .generic import generic_of, term_in_words
from .result import (
    Dependence,
    Detectable,
    DiagnosisSettings,
    FoundEffect,
    Gap,
    Identifiable,
    IntervalEstimate,
    Known,
    Residual,
    Result,
    Seeds,
    Stratum,
    Unexplained,
    Versions,
)
from .sizes import size_estimates
from .where import Ranked, View, ranked, views


def result_of(
    session: Session, search: Search, identifiability: Identifiability, diagnosis: Diagnosis,
    generic: Sequence[GenericTerm] = (), file: Accepted | None = None,
) -> Result:  # fmt: skip
    """The result of a search in a session, of the generic terms for what it left, and of which file is
    written."""
    settings, models = search.settings, views(search, diagnosis)
    first, last = next(iter(models.values())), [*models.values()][-1]
    effects = [_effect(diagnosis, found, session.origin_us, settings) for found in diagnosis.found]
    return Result(
        verdict=diagnosis.verdict,
        sentence=(
            sentence(diagnosis, first, last, settings)
            + _by_kind(diagnosis)
            + "".join(f" {term_in_words(term)}" for term in generic)
            + _far_from_file(diagnosis, settings)
            + _taken_out(session, file)
            + ("" if file is None else file.sentence())
        ),
        effects=effects,
        residual=_residual(diagnosis),
        where=_strata(ranked(first, search.data), settings.reporting),
        where_after=_strata(ranked(last, search.data), settings.reporting),
        gap=Gap(before=first.held_out, after=last.held_out, floor=last.floor),
        remains=_remains(diagnosis, settings),
        generic=[generic_of(term) for term in generic],
        file=None if file is None else file.record(),
        identifiability=Identifiable(
            base=[
                Known(name=f"{one.effect}.{one.name}", fixed=one.answer, sd=one.sd, mixed_with=one.mixed_with)
                for one in identifiability.base
            ],
            effects=[
                Detectable(name=one.effect, parameter=one.name, size=one.size, unit=one.unit)
                for one in identifiability.effects
            ],
        ),
        seeds=Seeds(
            seed=session.seed, twins=list(settings.runs.twins), signatures=list(settings.runs.signatures),
            fitting=list(settings.runs.fitting),
        ),
        versions=Versions(
            voltcam=metadata.version("voltcam"), numpy=np.__version__, python=platform.python_version()
        ),
        settings=DiagnosisSettings(
            recording=session.name, camera=session.camera.name, looked_at=session.looked_at(),
            seconds=session.seconds, columns=session.columns.tolist(),
            upsampling=str(session.rig.setting.scene.how), taken_out=list(session.taken_out),
            not_searched=list(session.left_out), alpha=settings.score_test.alpha,
        ),
    )  # fmt: skip


def sentence(diagnosis: Diagnosis, first: View, last: View, settings: SearchSettings = DEFAULTS) -> str:
    """The verdict in one; first and last are models before and after."""
    gap = f"the gap to the measurement on held-out data {_fell(first, last)}"
    step, residual = diagnosis.steps[-1], diagnosis.residual
    left = more_than_light(step, diagnosis.steps[0], diagnosis.remains, settings)
    form = "" if residual is None else f" A term of unknown origin, {residual.formula}, explains part of it."
    if diagnosis.verdict == "effects":
        names = " and ".join(dict.fromkeys(_with_rivals(found) for found in diagnosis.found))
        rest = " What is left has no name in the catalogue." if left else ""
        return f"The camera file lacks {names}. With that added, {gap}.{rest}{form}"
    if diagnosis.verdict == "none":
        return (
            f"Nothing is missing: with base parameters fitted, {gap}, where chance leaves {last.floor:.2f}"
            f" and the light between frames up to {settings.most_by_light:.2f} more."
        )
    chance = "" if first is not last else f", chance alone would leave {last.floor:.2f}"
    near = "".join(
        f" {in_words(one.candidate.effect).capitalize()} comes nearest, and leaves {one.held_out:.2f}."
        for one in diagnosis.steps[0].trials[:1]
    )
    return f"Something is missing, and nothing in the catalogue explains it: {gap}{chance}.{near}{form}"


def _remains(diagnosis: Diagnosis, settings: SearchSettings) -> Unexplained | None:
    if (found := diagnosis.remains) is None:
        return None
    kinds = [
        Dependence(
            kind=step.covariate.kind,
            covariate=step.covariate.name,
            nats=step.gain,
            sentence=kind_in_words(step),
        )
        for step in found.telling
    ]
    return Unexplained(
        nats=found.noticed, floor=found.by_light.floor, evidence=found.evidence,
        by_light=settings.naming.light_nats + found.by_larger_errors, kinds=kinds,
    )  # fmt: skip


def _by_kind(diagnosis: Diagnosis) -> str:
    """What is left that matters, by its kind."""
    found = diagnosis.remains
    if diagnosis.verdict == "none" or found is None or not found.telling:
        return ""
    return f" What is left by kind: {kind_in_words(found.telling[0])}"


def _far_from_file(diagnosis: Diagnosis, settings: SearchSettings) -> str:
    if not (off := diagnosis.hypothesis.far_from_file(settings)):
        return ""
    times = " and ".join(
        f"{name} is {times:.2g} times what the camera file says" for name, times in off.items()
    )
    return (
        f" In the fitted model {times}: is the file of another camera (voltcam calibrate makes one of this),"
        " or light known only where little moves?"
    )


def _taken_out(session: Session, file: Accepted | None) -> str:
    if not session.taken_out:
        return ""
    names = ", ".join(map(in_words, session.taken_out))
    gone = "They are taken out" if file is None or file.way == "fitted" else "They stay in the new file"
    better = "Events in known light are better explained without these effects of the camera file"
    return f" {better}: {names}. {gone}."


def _effect(diagnosis: Diagnosis, found: Found, origin_us: int, settings: SearchSettings) -> FoundEffect:
    before, after = found.step, diagnosis.after(found)
    return FoundEffect(
        name=found.effect,
        parameters=size_estimates(diagnosis, found.trial.candidate, origin_us, settings),
        gap_before=before.held_out,
        gap_after=after.held_out,
        gap_floor=after.floor_held_out,
        p_value=before.p_value,
        odds=float(np.exp(found.evidence.log_odds)),
        stand_ins=found.evidence.wrong,
        rivals=list(found.rivals),
        next_recording=next_recording(found.effect, found.rivals) if found.rivals else None,
    )


def _residual(diagnosis: Diagnosis) -> Residual | None:
    one, last = diagnosis.residual, diagnosis.steps[-1]
    if one is None:
        return None
    return Residual(
        name="residual_drift" if one.trial.candidate.effect == "residual_drift" else "residual_noise",
        formula=one.formula,
        others=list(one.others),
        gap_before=last.held_out,
        gap_after=one.trial.held_out,
        gap_floor=last.floor_held_out,
        p_value=one.step.p_value,
    )


def _strata(found: Ranked, reporting: Reporting) -> list[Stratum]:
    """The worst of those that are beyond chance; of none, the worst few."""
    order = found.order()
    beyond = int((found.q < reporting.false_discoveries).sum())
    return [
        Stratum(
            group=LABELS[i].group,
            statistic=LABELS[i].name,
            strata=dict(LABELS[i].strata),
            z=float(found.z[i]),
            q_value=float(found.q[i]),
            measured=float(found.measured[i]),
            expected=float(found.expected[i]),
            unit="share" if COUNTS[i] else "value",
            effect=IntervalEstimate(
                value=float(found.difference[i]), low=float(found.low[i]), high=float(found.high[i])
            ),
        )
        for i in order[: min(max(beyond, reporting.fewest_strata), reporting.most_strata)]
    ]


def _with_rivals(found: Found) -> str:
    name = in_words(found.effect)
    if not found.rivals:
        return name
    return f"{name} (or {' or '.join(map(in_words, found.rivals))}, which explain this recording as well)"


def _fell(first: View, last: View) -> str:
    if first is last:
        return f"is {first.held_out:.2f}"
    floor = f"where chance alone leaves {last.floor:.2f}"
    return f"falls from {first.held_out:.2f} to {last.held_out:.2f}, {floor}"
