"""Events as lines of four numbers: what the `.txt` and `.csv` formats share."""

import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import EVENT, Events
from voltcam_client.formats.recording import MAX_T_US, FormatError

CUT = set("0123456789.+-e, \t\r")
LONGEST_HEADER = 1000  # characters: beyond that a file is none of events


@dataclass(frozen=True)
class Layout:
    """How a line is laid out: its columns in words, what is between them (None: blanks), the unit of t.

    header: a pattern that the first line must match; None where the first line is an event.
    """

    columns: str
    separator: str | None
    seconds: bool
    header: str | None = None

    @property
    def t_limit(self) -> int:
        return MAX_T_US // 1_000_000 if self.seconds else MAX_T_US


def format_rows(row_format: str, *columns: NDArray[Any]) -> bytes:
    """One line per row of the integer columns, by one %-format: 5 million events per second."""
    rows = np.column_stack(columns)
    return (row_format * len(rows) % tuple(rows.ravel().tolist())).encode("ascii")


def read_events(path: Path, layout: Layout) -> Events:
    """The events of a text file; a last line that a crash has cut short is left out.

    Raises FormatError with the line number of what is not an event. Lines starting with # are comments.
    """
    line_type = np.dtype([("t", "<f8" if layout.seconds else "<i8"), ("x", "<u2"), ("y", "<u2"), ("p", "u1")])
    with path.open(encoding="utf-8", errors="replace") as file, warnings.catch_warnings():
        warnings.filterwarnings("ignore", "loadtxt: input contained no data")
        try:
            lines = _whole_lines(path, file, layout)
            rows = np.loadtxt(lines, line_type, delimiter=layout.separator, ndmin=1)
            if not np.all((rows["t"] >= 0) & (rows["t"] < layout.t_limit) & (rows["p"] <= 1)):
                raise ValueError("a number is out of range")
        except FormatError:
            raise
        except ValueError as error:
            fault = _first_fault(path, layout) or "a line is no event: give four numbers in each"
            raise FormatError(f"{path}, {fault}") from error
    events = np.empty(rows.size, EVENT)
    events["t"] = np.rint(rows["t"] * 1e6) if layout.seconds else rows["t"]
    for column in "xyp":
        events[column] = rows[column]
    return events


def _whole_lines(path: Path, file: TextIO, layout: Layout) -> Iterator[str]:
    """The lines below the header, without a cut last one."""
    if layout.header and not re.fullmatch(layout.header, file.readline(LONGEST_HEADER).strip()):
        raise FormatError(f"{path}, line 1: the header must be {layout.columns!r}: put it there")
    for line in file:
        if line.endswith("\n") or sum(map(bool, line.split(layout.separator))) == 4:
            yield line
        elif not set(line) <= CUT:  # a crash leaves the beginning of an event
            raise FormatError(f"{path} is no text of events: give lines {layout.columns!r}")


def _first_fault(path: Path, layout: Layout) -> str | None:
    """'line N: what is wrong with it', or None; slow, for a file already known to be wrong."""
    with path.open(encoding="utf-8", errors="replace") as file:
        for number, line in enumerate(_whole_lines(path, file, layout), start=2 if layout.header else 1):
            text = line.partition("#")[0].strip()
            if text and not _is_event(text.split(layout.separator), layout):
                return (  # without the line itself: who asks over the network may not be allowed to read it
                    f"line {number}: it is not {layout.columns!r}: "
                    "x and y are 0 to 65535, p is 0 or 1; correct the line or take it out"
                )
    return None


def _is_event(fields: list[str], layout: Layout) -> bool:
    try:
        t = float(fields[0]) if layout.seconds else int(fields[0])
        x, y, p = (int(field) for field in fields[1:])
    except ValueError:
        return False
    return 0 <= t < layout.t_limit and 0 <= x < 1 << 16 and 0 <= y < 1 << 16 and p in (0, 1)
