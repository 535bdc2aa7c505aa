"""manifest.jsonl of a data set: a line for each item, or for why there is none.

While a set is made, lines come in the order in which items are done; at the end they are sorted by name.
There is nothing of a clock in them, and of the machine only the versions of its software.
"""

import fcntl
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from voltcam_client.formats.writer import AppendFile

from ..problems import UsageError, one_line
from .item import ItemOutcome

NAME = "manifest.jsonl"

Key = tuple[str, int]
Record = dict[str, Any]


class SetManifest:
    """Of the set in `folder`; a line is on the disk when `add` returns. Raises UsageError, OSError."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / NAME
        self.records: dict[Key, Record] = {key_of(line): line for line in _lines(self.path, cut=True)}
        self._file: AppendFile | None = None

    def add(self, outcome: ItemOutcome) -> None:
        """Raises OSError, with the manifest as it was."""
        if self._file is None:
            self._file = AppendFile.continued(self.path)
        self._file.append(_text(outcome.record))
        self.records[outcome.item.key] = outcome.record

    def finish(self) -> None:
        """Sorted, each item once. Raises OSError, with the manifest as it was."""
        if self._file is not None:
            self._file.close()
            self._file = None
        sorted_path = self.path.with_name(f".{NAME}")
        with sorted_path.open("wb") as file:
            for key in sorted(self.records):
                file.write(_text(self.records[key]))
            file.flush()
            os.fsync(file.fileno())
        sorted_path.replace(self.path)


def read_manifest(folder: Path) -> list[Record]:
    """The lines of a set. Raises UsageError where there is none."""
    path = folder / NAME
    if not path.exists():
        raise UsageError(f"{folder} is no data set: it has no {NAME}")
    newest = {key_of(line): line for line in _lines(path)}
    return [newest[key] for key in sorted(newest)]


def key_of(record: Record) -> Key:
    """What an item is called."""
    return str(record["name"]), int(record["variant"])


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Nobody else makes this set meanwhile. Raises UsageError where someone does, OSError."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    except BlockingIOError:
        raise UsageError(f"{folder}: another program makes this set: wait, or give another folder") from None
    finally:
        os.close(descriptor)


def _lines(path: Path, *, cut: bool = False) -> Iterator[Record]:
    """cut: half a line at the end, of a crash, is removed."""
    if not path.exists():
        return
    whole = 0
    with path.open("rb") as file:
        for number, line in enumerate(file, start=1):
            if not line.endswith(b"\n"):
                break
            try:
                record = json.loads(line)
                key_of(record)
            except (ValueError, LookupError, TypeError, RecursionError) as error:
                raise UsageError(f"{path}, line {number} is no item's: {one_line(error)}") from None
            whole += len(line)
            yield record
    if cut:
        os.truncate(path, whole)


def _text(record: Record) -> bytes:
    return (json.dumps(record, ensure_ascii=False) + "\n").encode()
