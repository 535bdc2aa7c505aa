"""Paths that come over the network: names below a folder, and nothing else."""

from collections.abc import Sequence
from pathlib import Path

LONGEST_NAME = 200


class AccessError(ValueError):
    """What was asked for is not allowed: one line with the remedy."""


def resolve_under(folders: Sequence[Path], name: str) -> Path:
    """The path that `name` means, relative to the first folder or absolute, below one of the folders.

    Links are followed first: one that leads outside is outside. Raises AccessError.
    """
    if "\0" in name or any(len(part.encode()) > LONGEST_NAME for part in Path(name).parts):
        raise AccessError(f"{name[:40]!r} is no name for a file: give one of at most {LONGEST_NAME} bytes")
    roots: list[Path] = []
    try:
        roots = [folder.resolve() for folder in folders]
        path = (roots[0] / name).resolve() if roots else None
    except (OSError, RuntimeError, ValueError):
        path = None
    if path is None or not any(path.is_relative_to(root) for root in roots):
        raise AccessError(
            f"{name[:80]!r} is outside of the folders that are open to the network: ask its operator"
        )
    return path
