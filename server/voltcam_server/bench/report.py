"""The figures of `voltcam bench` as JSON, and held against those of an older run."""

import json
import os
import platform
from dataclasses import asdict
from importlib import metadata
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from ..problems import UsageError
from .figure import Figure

FORMAT = 1


class BenchReport(BaseModel):
    """What `voltcam bench --json` prints."""

    model_config = ConfigDict(extra="ignore")

    format: int = FORMAT
    voltcam: str
    numba: str
    python: str
    cores: int
    figures: list[Figure]

    @classmethod
    def of(cls, figures: list[Figure]) -> "BenchReport":
        """These figures, of the software and machine that is running."""
        return cls(
            voltcam=metadata.version("voltcam"), numba=metadata.version("numba"),
            python=platform.python_version(), cores=os.cpu_count() or 1, figures=figures,
        )  # fmt: skip

    @classmethod
    def read(cls, path: Path) -> "BenchReport":
        """From a file. Raises UsageError, a line, where it is not one."""
        try:
            report = cls.model_validate_json(path.read_bytes())
        except OSError as error:
            raise UsageError(
                f"{path}: {error.strerror}: give a file made by `voltcam bench --json`"
            ) from error
        except ValidationError as error:
            raise UsageError(f"{path} is no result of `voltcam bench --json`: make one with it") from error
        if report.format != FORMAT:
            raise UsageError(f"{path} is of format {report.format}, this Voltcam compares format {FORMAT}")
        return report

    def to_json(self) -> str:
        """One figure a line."""
        head = json.dumps(self.model_dump(exclude={"figures"}))[:-1]
        lines = ",\n  ".join(json.dumps(asdict(figure)) for figure in self.figures)
        return f'{head}, "figures": [\n  {lines}\n]}}\n'

    def against(self, old: "BenchReport") -> str:
        """A line for each figure that both have; the names of those that only one has."""
        former = {figure.name: figure for figure in old.figures}
        now = {figure.name for figure in self.figures}
        lines = [f"this run, held against Voltcam {old.voltcam}, numba {old.numba}, {old.cores} cores:"]
        lines += [one.beside(former[one.name]) for one in self.figures if one.name in former]
        lines += [f"{name}: only in this run" for name in sorted(now - former.keys())]
        lines += [f"{name}: only in the older run" for name in sorted(former.keys() - now)]
        return "\n".join(lines)
