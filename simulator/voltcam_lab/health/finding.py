"""What a health report consists of."""

from dataclasses import asdict, dataclass
from typing import Any, Literal

Severity = Literal["good", "limits", "fatal"]
Answer = Literal["yes", "in part", "no"]


@dataclass(frozen=True)
class Finding:
    """One thing looked at. words: a line for a person; numbers: what it rests on, ready for JSON."""

    name: str
    severity: Severity
    words: str
    numbers: dict[str, Any]


class EventsLate(Finding):
    """Events that come later than light explains: another clock, or a readout that cannot keep up."""

    @property
    def late_us(self) -> float:
        """Behind the light of the frames."""
        return float(self.numbers["late_us"])


@dataclass(frozen=True)
class Determination:
    """Whether this recording fixes some parameters, and why or why not, in a line."""

    parameters: tuple[str, ...]
    answer: Answer
    words: str
    numbers: dict[str, Any]


@dataclass(frozen=True)
class Health:
    """The report on one recording."""

    findings: tuple[Finding, ...]
    determinations: tuple[Determination, ...] = ()

    @property
    def usable(self) -> bool:
        """Whether a camera can be calibrated from it at all."""
        return not self.fatal

    @property
    def fatal(self) -> tuple[Finding, ...]:
        """What makes it useless."""
        return tuple(finding for finding in self.findings if finding.severity == "fatal")

    def __getitem__(self, name: str) -> Finding:
        """The finding of this name. KeyError."""
        for finding in self.findings:
            if finding.name == name:
                return finding
        raise KeyError(name)

    def text(self) -> str:
        """Lines for a terminal: the verdict first, then what limits, then what is well."""
        mark = {"fatal": "[X]", "limits": "[!]", "good": "[ok]"}
        order = list(mark)
        lines = [self._verdict()]
        for finding in sorted(self.findings, key=lambda finding: order.index(finding.severity)):
            lines.append(f"  {mark[finding.severity]:<4} {finding.name}: {finding.words}")
        if self.determinations:
            lines.append("What it can determine:")
        for item in self.determinations:
            lines.append(f"  {item.answer:<7} {', '.join(item.parameters)}: {item.words}")
        return "\n".join(lines)

    def as_dict(self) -> dict[str, Any]:
        """The same for machines."""
        return {
            "usable": self.usable,
            "findings": [asdict(finding) for finding in self.findings],
            "determinations": [asdict(item) for item in self.determinations],
        }

    def _verdict(self) -> str:
        if not self.usable:
            return f"This recording cannot be used: {'; '.join(f.words for f in self.fatal)}"
        limits = sum(finding.severity == "limits" for finding in self.findings)
        return f"This recording can be used{f', with {limits} reservations' if limits else ''}."
