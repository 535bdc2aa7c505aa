"""Recordings on disk, one file here per format; the suffix says which.

    with open_writer("out.npz", width=346, height=260) as writer:
        writer.events(events)
    recording = read("out.npz")

What goes wrong with names and contents is a FormatError, with the disk a RecordingError; both are one line to
show to the user.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from voltcam_client.formats import csv, npz, raw, spool, txt
from voltcam_client.formats.recording import FormatError, Recording, RecordingError, fault_in
from voltcam_client.formats.writer import Writer

__all__ = ["SUFFIXES", "FormatError", "Recording", "RecordingError", "Writer", "open_writer", "read"]


class _OpenWriter(Protocol):
    def __call__(self, path: Path, width: int, height: int, *, overwrite: bool) -> Writer: ...


_FORMATS: dict[str, tuple[str, _OpenWriter, Callable[[Path], Recording]]] = {
    ".npz": (npz.DESCRIPTION, npz.NpzWriter, npz.read_npz),
    ".txt": (txt.DESCRIPTION, txt.TxtWriter, txt.read_txt),
    ".csv": (csv.DESCRIPTION, csv.CsvWriter, csv.read_csv),
    ".raw": (raw.DESCRIPTION, raw.RawWriter, raw.read_raw),
}

SUFFIXES = {suffix: description for suffix, (description, _, _) in _FORMATS.items()}
"""What each suffix holds, in a line for `--help`."""


def open_writer(path: str | Path, *, width: int, height: int, overwrite: bool = False) -> Writer:
    """Begin a recording of a width x height camera, in the format of the path's suffix.

    Raises FormatError for a suffix that is none of SUFFIXES, RecordingError where the file exists already and
    `overwrite` is false, or cannot be made.
    """
    path = Path(path)
    _, writer, _ = _format_of(path)
    return writer(path, width, height, overwrite=overwrite)


def read(path: str | Path) -> Recording:
    """Read a recording: a file with one of SUFFIXES, an unfinished FILE.npz.partial, or an Event Camera
    Dataset folder (events.txt, images.txt).

    Raises FormatError for anything else, naming what is wrong where; RecordingError where it cannot be read.
    """
    path = Path(path)
    try:
        path.stat()  # one that is not there is no matter of formats
        recording = _reader_of(path)(path)
    except OSError as error:
        raise RecordingError(
            f"{path} cannot be read: {error.strerror}: check the name and its rights"
        ) from error
    fault = fault_in(recording.events, recording.width, recording.height)
    if fault:
        raise FormatError(f"{path}, {fault}")
    return recording


def _reader_of(path: Path) -> Callable[[Path], Recording]:
    if path.suffix == npz.PARTIAL:
        return spool.read_spool
    if not path.is_dir():
        return _format_of(path)[2]
    if (path / "events.txt").exists():
        return txt.read_folder
    raise FormatError(
        f"{path} is a folder without an events.txt: give a recording, or a folder with events.txt"
    )


def _format_of(path: Path) -> tuple[str, _OpenWriter, Callable[[Path], Recording]]:
    try:
        return _FORMATS[path.suffix.lower()]
    except KeyError:
        formats = "; ".join(f"{suffix} ({description})" for suffix, description in SUFFIXES.items())
        raise FormatError(f"{path}: no recording has the suffix {path.suffix!r}: choose {formats}") from None
