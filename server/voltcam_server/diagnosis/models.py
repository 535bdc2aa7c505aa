"""What a diagnosis is asked for over REST, and what it says of itself."""

from typing import Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator
from pydantic.config import JsonDict

from .gather import Figures


def _only(name: str) -> JsonDict:
    """In JSON schema: this one of the two, and not the other."""
    other = {"reference": "stream", "stream": "reference"}[name]
    return {"required": [name], "properties": {name: {"type": "string"}, other: {"type": "null"}}}


class DiagnosisRequest(BaseModel):
    """What to hold the camera against: a recording, or a second camera."""

    model_config = ConfigDict(
        use_attribute_docstrings=True,
        extra="forbid",
        json_schema_extra={"oneOf": [_only("reference"), _only("stream")]},
    )

    reference: str | None = Field(default=None, min_length=1, max_length=4096)
    """a recording on the daemon's host; this or stream"""

    stream: str | None = Field(
        default=None, pattern=r"^(tcp|ipc)://\S+$", max_length=4096, examples=["tcp://127.0.0.1:5561"]
    )
    """ZeroMQ address of a camera that looks at the same scene; this or reference"""

    seconds: float = Field(default=10, gt=0, le=60)
    """of it to look at, s"""

    @model_validator(mode="after")
    def _one_of_them(self) -> Self:
        if (self.reference is None) == (self.stream is None):
            raise ValueError("give either reference, a recording's path, or stream, a camera's address")
        return self


class DiagnosisState(BaseModel):
    """One diagnosis: what of, how far it is, what it found."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    state: Literal["idle", "gathering", "running", "done", "failed"] = "idle"
    """how far it is"""

    reference: str = ""
    """what the camera is held against"""

    progress: list[str] = []
    """sentences, the newest last"""

    figures: Figures | None = None
    """while gathering"""

    error: str = ""
    """in one line, when failed"""

    result: dict[str, Any] | None = None
    """result.json, when done"""

    folder: str = ""
    """where its files are, on the daemon's host"""

    acceptable: bool = False
    """whether there is something to accept"""

    revertible: bool = False
    """whether there is something to revert"""
