"""A recording put to the diagnosis, and what it says."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal

from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

from voltcam_client.formats import FormatError, Recording
from voltcam_lab.diagnosis.outcome.generic import terms_left
from voltcam_lab.diagnosis.outcome.result import IntervalEstimate
from voltcam_lab.diagnosis.outcome.sizes import size_estimates
from voltcam_lab.diagnosis.residual.fit import GenericTerm
from voltcam_lab.diagnosis.rig.rig import Rig
from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.loop import Diagnosis, diagnose
from voltcam_lab.diagnosis.search.state import Search
from voltcam_lab.diagnosis.session import DiagnosisError, session_of
from voltcam_lab.health import inspect
from voltcam_lab.recordings import with_frames
from voltcam_simulator import Camera, Parameters

# What a camera file knows: published sets (DVS-Voltmeter, ECCV 2022), thresholds of other makes.
_PUBLISHED: dict[str, tuple[str, dict[str, dict[str, Any]]]] = {
    "davis346": ("paper", {}),
    "davis240c": ("paper240c", {}),
    "esim": ("ideal", {"contrast_response": {"k1": 4, "k2_dn": 0.3}}),
    "v2e": ("ideal", {"contrast_response": {"k1": 5, "k2_dn": 0.3}}),
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Question:
    """All that the diagnosis gets. without: effect to leave out of the catalogue."""

    events: NDArray[Any]
    frames: NDArray[Any]
    frame_t_us: NDArray[Any]
    width: int
    height: int
    camera: str  # whose published set is the camera file
    without: str | None = None


class Named(BaseModel):
    """An effect that the diagnosis named."""

    model_config = ConfigDict(frozen=True)

    name: str
    rivals: tuple[str, ...] = ()
    parameters: dict[str, IntervalEstimate] = {}


class Verdict(BaseModel):
    """What it said; "refused" where it found the recording itself bad. Gaps are on held-out data; the p-value
    is that of the first step."""

    model_config = ConfigDict(frozen=True)

    verdict: Literal["effects", "none", "unknown", "refused"]
    effects: tuple[Named, ...] = ()
    formula: str = ""  # of the generic term that explains part of an unknown effect
    gap_with_formula: float | None = None  # that which it leaves, beside gap_after without it
    gap_before: float = 0.0
    gap_after: float = 0.0
    gap_floor: float = 0.0
    p_value: float = 0.0
    kinds: tuple[str, ...] = ()  # on what firing depends that the model's does not, the most telling first
    nats_before: float | None = None  # an event, on the later part, without generic terms...
    nats_after: float | None = None  # ...and with them
    reason: str = ""  # of a refusal


def ask(question: Question) -> Verdict:
    """The diagnosis' verdict."""
    camera = Camera(name=question.camera, width=question.width, height=question.height)
    camera = camera.model_copy(update={"parameters": _published(question.camera)})
    recording = Recording(
        question.events, question.width, question.height, question.frames, question.frame_t_us
    )
    try:
        with TemporaryDirectory() as folder:
            session = session_of(inspect(with_frames(recording)), camera, Path(folder))
    except (DiagnosisError, FormatError) as error:
        return Verdict(verdict="refused", reason=str(error))
    rig = Rig(session.rig.setting)
    candidates = [one for one in session.candidates if one.effect != question.without]
    search = Search(rig, session.data, candidates, sensor=session.sensor)
    diagnosis = diagnose(search, Hypothesis(session.parameters))
    return _verdict(diagnosis, terms_left(session.sensor, diagnosis, lambda sentence: None))


def _published(camera: str) -> Parameters:
    preset, changes = _PUBLISHED[camera]
    return Parameters.of(preset).changed(changes)


def _verdict(diagnosis: Diagnosis, terms: Sequence[GenericTerm]) -> Verdict:
    first, last = diagnosis.steps[0], diagnosis.steps[-1]
    effects = tuple(
        Named(
            name=found.effect,
            rivals=found.rivals,
            parameters=size_estimates(diagnosis, found.trial.candidate),
        )
        for found in diagnosis.found
    )
    residual, remains = diagnosis.residual, diagnosis.remains
    return Verdict(
        verdict=diagnosis.verdict, effects=effects, formula=residual.formula if residual else "",
        gap_with_formula=residual.trial.held_out if residual else None, gap_before=first.held_out,
        gap_after=last.held_out, gap_floor=last.floor_held_out, p_value=first.p_value,
        kinds=tuple(step.covariate.kind for step in remains.telling) if remains else (),
        nats_before=terms[0].before.noticed if terms else None,
        nats_after=terms[-1].after.noticed if terms else None,
    )  # fmt: skip
