"""A table beside frames, such as boxes or poses. It becomes ITEM.table.csv, as it was: with a column `t_us`,
or one `frame` (0 is the first), before which the column `t_us` then comes."""

import csv
from collections.abc import Iterator, Sequence
from pathlib import Path

from .labels import BesideError


def check_table(path: Path, frames: int | None) -> None:
    """Before anything is made. Raises BesideError."""
    head, rows = _read(path)
    for number, row in rows:
        value = _time(path, number, row, head)
        if "t_us" not in head and frames is not None and value >= frames:
            raise BesideError(f"{path}, line {number}: frame {value} of {frames}: frames count from 0")


def write_table(source: Path, path: Path, frame_t_us: Sequence[int]) -> int:
    """Rows up to the last frame; says how many. Raises BesideError."""
    head, rows = _read(source)
    timed, count = "t_us" in head, 0
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head if timed else ["t_us", *head])
        for number, row in rows:
            value = _time(source, number, row, head)
            if timed and value <= frame_t_us[-1]:
                writer.writerow(row)
            elif not timed and value < len(frame_t_us):
                writer.writerow([frame_t_us[value], *row])
            else:
                continue
            count += 1
    return count


def _read(path: Path) -> tuple[list[str], Iterator[tuple[int, list[str]]]]:
    """The head, and the lines after it by their numbers. Raises BesideError."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            lines = list(csv.reader(file))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise BesideError(f"{path} cannot be read as CSV: {error}") from None
    head = [name.strip() for name in lines[0]] if lines else []
    if "t_us" not in head and "frame" not in head:
        raise BesideError(f"{path} has no column t_us or frame, only {', '.join(head)}: name its times so")
    return head, ((number, line) for number, line in enumerate(lines[1:], start=2) if line)


def _time(path: Path, number: int, row: list[str], head: list[str]) -> int:
    """What its line says of its time."""
    try:
        value = int(row[head.index("t_us" if "t_us" in head else "frame")])
    except (ValueError, IndexError):
        raise BesideError(f"{path}, line {number}: its time is no whole number; correct the line") from None
    if value < 0:
        raise BesideError(f"{path}, line {number}: its time is {value}; give 0 or more")
    return value
