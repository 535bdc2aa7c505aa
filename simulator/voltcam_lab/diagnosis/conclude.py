"""The result of a diagnosis, put together from what the search left; nothing is simulated anew."""

import platform
from importlib import metadata

import numpy as np

from voltcam_simulator import Camera

from ..battery import COUNTS, LABELS
from .advice import next_recording
from .catalogue import TURNS, Asymmetry, Candidate, Lamp
from .clock import counted_from, later_turns
from .identify import Identifiability
from .loop import Diagnosis, Found
from .model import BASE
from .proof import TOLERANCE
from .result import (
    Detectable,
    Effect,
    Estimate,
    Gap,
    Identifiable,
    Known,
    Residual,
    Result,
    Seeds,
    Settings,
    Stratum,
    Versions,
)
from .search import ALPHA, SIGNATURE
from .session import Session
from .trial import FITTING
from .where import Ranked, View, ranked, views

MOST_STRATA = 50
_90 = 1.645
_SYSTEMATIC = 0.16  # of a size, for its form and the light: so 21 of 23 of the generator's are covered
_BEYOND = 0.1  # false discovery rate


def result_of(session: Session, told: Identifiability, diagnosis: Diagnosis) -> Result:
    """The result."""
    seen = views(session.rig, diagnosis, session.data)
    first, last = next(iter(seen.values())), [*seen.values()][-1]
    effects = [_effect(diagnosis, found, session.origin_us) for found in diagnosis.found]
    return Result(
        verdict=diagnosis.verdict,
        sentence=sentence(diagnosis, first, last) + _far_off(diagnosis) + _taken_out(session),
        effects=effects,
        residual=_residual(diagnosis),
        where=_strata(ranked(first, session.data)),
        where_after=_strata(ranked(last, session.data)),
        gap=Gap(before=first.held_out, after=last.held_out, floor=last.floor),
        identifiability=Identifiable(
            base=[
                Known(name=f"{one.effect}.{one.name}", fixed=one.answer, sd=one.sd, mixed_with=one.mixed_with)
                for one in told.base
            ],
            effects=[
                Detectable(name=one.effect, parameter=one.name, size=one.size, unit=one.unit)
                for one in told.effects
            ],
        ),
        seeds=Seeds(
            seed=session.seed, twins=list(last.spread.seeds), signatures=list(SIGNATURE),
            fitting=list(FITTING),
        ),
        versions=Versions(
            voltcam=metadata.version("voltcam"), numpy=np.__version__, python=platform.python_version()
        ),
        settings=Settings(
            recording=session.name, camera=session.camera.name, looked_at=session.looked_at(),
            seconds=session.seconds, columns=session.columns.tolist(),
            upsampling=str(session.rig.setting.scene.how), taken_out=list(session.taken_out),
            not_searched=list(session.left_out), alpha=ALPHA,
        ),
    )  # fmt: skip


def camera_of(session: Session, diagnosis: Diagnosis) -> Camera:
    """The camera file with what was missing in it, of the recording's size."""
    found = counted_from(diagnosis.model.parameters(), -session.origin_us)
    return session.camera.model_copy(update={"parameters": found})


def sentence(diagnosis: Diagnosis, first: View, last: View) -> str:
    """The verdict in one; first and last are models before and after."""
    gap = f"the gap to the measurement on held-out data {_fell(first, last)}"
    step, residual = diagnosis.steps[-1], diagnosis.residual
    left = step.training - step.floor_training > TOLERANCE
    form = "" if residual is None else f" A term of unknown origin, {residual.formula}, explains part of it."
    if diagnosis.verdict == "effects":
        names = " and ".join(dict.fromkeys(_with_rivals(found) for found in diagnosis.found))
        rest = " What is left has no name in the catalogue." if left else ""
        return f"The camera file lacks {names}. With that added, {gap}.{rest}{form}"
    if diagnosis.verdict == "none":
        return (
            f"Nothing is missing: with base parameters fitted, {gap}, as near as chance lets it come"
            f" ({last.floor:.2f})."
        )
    chance = "" if first is not last else f", chance alone would leave {last.floor:.2f}"
    near = "".join(
        f" {in_words(one.candidate.effect).capitalize()} comes nearest, and leaves {one.held_out:.2f}."
        for one in diagnosis.steps[0].trials[:1]
    )
    return f"Something is missing, and nothing in the catalogue explains it: {gap}{chance}.{near}{form}"


def _far_off(diagnosis: Diagnosis) -> str:
    if not (off := diagnosis.model.far_off):
        return ""
    times = " and ".join(
        f"{name} is {times:.2g} times what the camera file says" for name, times in off.items()
    )
    return (
        f" In the fitted model {times}: is the file of another camera (voltcam calibrate makes one of this),"
        " or light known only where little moves?"
    )


def _taken_out(session: Session) -> str:
    if not session.taken_out:
        return ""
    names = ", ".join(map(in_words, session.taken_out))
    return f" Taken out of the camera file, as the recording is better explained without: {names}."


def in_words(effect: str) -> str:
    """An effect's registry name for a sentence."""
    return {"comparator": "unequal thresholds", "readout": "readout saturation"}.get(
        effect, effect.replace("_", " ")
    )


def intervals(diagnosis: Diagnosis, candidate: Candidate, origin_us: int = 0) -> dict[str, Estimate]:
    """Of an accepted effect's sizes, by its own parameters' names, on a clock whose zero the diagnosis has at
    -origin_us."""
    place, model = len(BASE), diagnosis.model
    sizes = next(
        place + sum(len(size) for _, size in model.accepted[:k]) + np.arange(len(candidate.names))
        for k, (one, _) in enumerate(model.accepted)
        if (one.effect, one.names) == (candidate.effect, candidate.names)
    )
    assert diagnosis.covariance is not None
    sd = np.sqrt(np.diag(diagnosis.covariance)[sizes] + _SYSTEMATIC**2)
    effect = getattr(model.parameters(), candidate.effect)
    if isinstance(candidate, Asymmetry):  # half of the ratio's logarithm each
        return {name: _around(getattr(effect, name), float(sd[0]) / 2) for name in ("theta_on", "theta_off")}
    if isinstance(candidate, Lamp):
        turns = later_turns(effect.phase_turns, effect.frequency_hz, -origin_us)
        off = _90 * TURNS * float(sd[1])
        phase = Estimate(value=turns, low=turns - off, high=turns + off)
        return {"depth": _around(effect.depth, float(sd[0])), "phase_turns": phase}
    return {
        name: _around(getattr(effect, name), float(one))
        for name, one in zip(candidate.names, sd, strict=True)
    }


def _around(value: float, sd: float) -> Estimate:
    ends = sorted((value * float(np.exp(-_90 * sd)), value * float(np.exp(_90 * sd))))
    return Estimate(value=value, low=ends[0], high=ends[1])


def _effect(diagnosis: Diagnosis, found: Found, origin_us: int) -> Effect:
    before, after = found.step, diagnosis.after(found)
    return Effect(
        name=found.effect,
        parameters=intervals(diagnosis, found.trial.candidate, origin_us),
        gap_before=before.held_out,
        gap_after=after.held_out,
        gap_floor=after.floor_held_out,
        p_value=before.p_value,
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


def _strata(found: Ranked) -> list[Stratum]:
    """The worst of those that are beyond chance; of none, the worst few."""
    order = found.order()
    beyond = int((found.q < _BEYOND).sum())
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
            effect=Estimate(
                value=float(found.difference[i]), low=float(found.low[i]), high=float(found.high[i])
            ),
        )
        for i in order[: min(max(beyond, 5), MOST_STRATA)]
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
