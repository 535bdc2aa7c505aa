"""What a diagnosis gives to machines, DIR/result.json: the schema."""

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

SCHEMA_DIALECT = "https://json-schema.org/draft/2020-12/schema"


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class IntervalEstimate(_Record):
    """A parameter's value and its 90 % interval."""

    value: float
    low: float
    high: float


class FoundEffect(_Record):
    """An effect that the camera file lacks. Gaps are those of the step that found it, on held-out data."""

    name: str = Field(description="as in the registry of effects, and in camera files")
    parameters: dict[str, IntervalEstimate]
    gap_before: float
    gap_after: float
    gap_floor: float = Field(description="what chance alone would leave")
    p_value: float = Field(description="of as large a gain from anything in the catalogue, without an effect")
    odds: float = Field(
        description="how much likelier what is left of the gap is if it is there than if it stood in for "
        "something without a name; of effects that are needed together, for all of them"
    )
    stand_ins: float = Field(description="share of stand-ins that have such odds")
    rivals: list[str] = Field(description="effects that explain this recording as well")
    next_recording: str | None = Field(description="the recording that would tell it from its rivals")


class Residual(_Record):
    """A term of unknown mechanism that explains part of a gap which no listed effect does."""

    name: Literal["residual_drift", "residual_noise"]
    formula: str
    others: list[str] = Field(description="forms that the recording cannot tell from it")
    gap_before: float
    gap_after: float
    gap_floor: float
    p_value: float


class Stratum(_Record):
    """A statistic that differs."""

    group: str = Field(description="letter of its group, A to K")
    statistic: str
    strata: dict[str, str]
    z: float = Field(description="measured less expected, of the spread of simulated twins")
    q_value: float = Field(description="false discovery rate (Benjamini and Hochberg)")
    measured: float
    expected: float
    unit: Literal["share", "value"] = Field(
        description="of the effect size: share of what is expected, or the statistic's own"
    )
    effect: IntervalEstimate = Field(description="effect size: measured less expected, with a 90 % interval")


class Gap(_Record):
    """Mean robust deviation per statistic on held-out data."""

    before: float
    after: float
    floor: float


class Dependence(_Record):
    """On what the firing of real pixels depends that the model's does not."""

    kind: str = Field(description="own past, neighbours, row, column, bus, clock or slow time")
    covariate: str
    nats: float = Field(description="nats an event that it tells, held out, beside those before it")
    sentence: str


class Unexplained(_Record):
    """By what, over all pixels, the recording can be told from simulated ones of the model in the end."""

    nats: float = Field(description="nats an event, beyond what the light between frames leaves open")
    floor: float = Field(description="nats an event that the light leaves open")
    evidence: float = Field(description="the same of all events that were looked at, in nats")
    by_light: float = Field(description="how much evidence is left in the mean where nothing is missing")
    kinds: list[Dependence] = Field(description="those that matter, the most telling first")


class Generic(_Record):
    """A term of unknown mechanism that takes away by what real events are told from simulated ones. Nats are
    of the later part of the recording, which had no part in the fit of its numbers, beyond what the light
    leaves open."""

    name: str = Field(description="as in the registry of effects, and in the camera file")
    kind: str = Field(description="as of `Dependence`")
    formula: str
    parameters: dict[str, float]
    nats_before: float
    nats_after: float
    sentence: str


Way = Literal["fitted", "found added", "as it was"]


class AcceptedFile(_Record):
    """Which camera file was written: the one whose events, of all pixels in any light, differ least from the
    recorded. "found added": the file that was given, with what was found."""

    way: Way
    difference: dict[Way, float] = Field(description="of each; 0: the same")


class Known(_Record):
    """A base parameter, and what the recording can tell of it. sd: of its logarithm."""

    name: str
    fixed: Literal["yes", "in part", "no"]
    sd: float
    mixed_with: dict[str, float] = Field(description="parameters that move with it, and the correlation")


class Detectable(_Record):
    """The smallest size of an effect that would be found; null: none would."""

    name: str
    parameter: str
    size: float | None
    unit: str


class Identifiable(_Record):
    """What the recording can tell at all, found by simulation before anything is fitted to it."""

    base: list[Known]
    effects: list[Detectable]


class Seeds(_Record):
    """Of random numbers; runs have seed * 2^20 + one of these."""

    seed: int
    twins: list[int]
    signatures: list[int]
    fitting: list[int]


class Versions(_Record):
    """Of the software."""

    voltcam: str
    numpy: str
    python: str


class DiagnosisSettings(_Record):
    """What was looked at, and how."""

    recording: str
    camera: str
    looked_at: str
    seconds: float
    columns: list[int] = Field(description="of the sensor that were looked at")
    upsampling: str = Field(description="how light between frames was found")
    taken_out: list[str] = Field(
        description="effects of the camera file without which events in known light are better explained"
    )
    not_searched: list[str] = Field(description="effects that the camera file has already, or cannot show")
    alpha: float = Field(description="chance of a name where nothing is missing")


class Result(_Record):
    """A diagnosis of a recording against a camera file."""

    verdict: Literal["effects", "none", "unknown"]
    sentence: str = Field(description="the verdict for a person")
    effects: list[FoundEffect]
    residual: Residual | None
    where: list[Stratum] = Field(description="where the fitted camera file disagrees, worst first")
    where_after: list[Stratum] = Field(description="the same with the effects added")
    gap: Gap
    remains: Unexplained | None
    generic: list[Generic] = Field(description="terms of unknown mechanism, each beside those before it")
    file: AcceptedFile | None = Field(description="which camera file was written; null where none was")
    identifiability: Identifiable
    seeds: Seeds
    versions: Versions
    settings: DiagnosisSettings


def schema() -> dict[str, Any]:
    """The JSON schema of result.json."""
    return {"$schema": SCHEMA_DIALECT, **Result.model_json_schema()}
