"""What a diagnosis is asked for over REST, and what it says of itself."""

from typing import Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator
from pydantic.config import JsonDict, JsonValue

from .gather import Figures


def _only(name: str) -> JsonDict:
    """In JSON schema: this one of the two, and not the other."""
    other = {"reference": "stream", "stream": "reference"}[name]
    return {"required": [name], "properties": {name: {"type": "string"}, other: {"type": "null"}}}


ONE_OF_THEM: list[JsonValue] = [_only("reference"), _only("stream")]


class DiagnosisRequest(BaseModel):
    """reference: a recording on the daemon's host. stream: the ZeroMQ address of a camera that looks at the
    same scene. seconds: of it to look at."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"oneOf": [_only("reference"), _only("stream")]}
    )

    reference: str | None = Field(default=None, min_length=1, max_length=4096)
    stream: str | None = Field(
        default=None, pattern=r"^(tcp|ipc)://\S+$", max_length=4096, examples=["tcp://127.0.0.1:5561"]
    )
    seconds: float = Field(default=10, gt=0, le=60)

    @model_validator(mode="after")
    def _one_of_them(self) -> Self:
        if (self.reference is None) == (self.stream is None):
            raise ValueError("give either reference, a recording's path, or stream, a camera's address")
        return self


class DiagnosisState(BaseModel):
    """One diagnosis: what of, how far it is, what it found.

    progress: sentences. figures: while gathering. error: in one line, when failed. result: result.json, when
    done. folder: where its files are, on the daemon's host. acceptable, revertible: whether there is
    something to accept or to revert.
    """

    state: Literal["idle", "gathering", "running", "done", "failed"] = "idle"
    reference: str = ""
    progress: list[str] = []
    figures: Figures | None = None
    error: str = ""
    result: dict[str, Any] | None = None
    folder: str = ""
    acceptable: bool = False
    revertible: bool = False
