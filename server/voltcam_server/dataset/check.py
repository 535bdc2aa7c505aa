"""A set held against its manifest: every file there, whole, and none that nobody knows."""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tqdm import tqdm

from .manifest import NAME, read_manifest

KNOWN = (NAME, "spec.json", "index.html")  # beside the items


@dataclass(frozen=True)
class Checked:
    """faults: a line each. failed: items that could not be made, which are no faults of the set."""

    folder: Path
    items: int
    files: int
    failed: int
    faults: tuple[str, ...]

    @property
    def words(self) -> str:
        """In a line."""
        good = "all as they were made" if not self.faults else f"{len(self.faults)} faults"
        lost = f"; {self.failed} inputs gave no item, as the manifest says" if self.failed else ""
        return f"{self.folder}: {self.items} items in {self.files} files, {good}{lost}"


def check_set(folder: Path) -> Checked:
    """Reads every file once. Raises UsageError where there is no set, or its manifest is none."""
    records = read_manifest(folder)
    made = [record for record in records if "failed" not in record]
    sums = {path: digest for record in made for path, digest in record["sha256"].items()}
    faults = [*_wrong(folder, sums), *_unknown(folder, set(sums))]
    return Checked(folder, len(made), len(sums), len(records) - len(made), tuple(faults))


def _wrong(folder: Path, sums: dict[str, str]) -> Iterator[str]:
    for path, digest in tqdm(sums.items(), desc="reading", unit=" files", disable=None, leave=False):
        try:
            with (folder / path).open("rb") as file:
                found = hashlib.file_digest(file, "sha256").hexdigest()
        except OSError as error:
            yield f"{path}: {error.strerror}: make the set again, which makes what is not there"
            continue
        if found != digest:
            yield f"{path}: not as it was made: remove it and make the set again"


def _unknown(folder: Path, known: set[str]) -> Iterator[str]:
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_file() and name not in known and name not in KNOWN:
            yield f"{name}: not in the manifest: remove it, or make the set to its end"
