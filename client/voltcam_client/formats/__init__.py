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

from voltcam_client.formats import aedat4, aedat4_writer, csv, hdf5, npz, raw, rosbag, spool, txt
from voltcam_client.formats.bounds import whole
from voltcam_client.formats.recording import (
    LONGEST_SIDE,
    FormatError,
    Recording,
    RecordingError,
    fault_in,
)
from voltcam_client.formats.writer import Writer, exists_already

__all__ = [
    "READABLE",
    "SUFFIXES",
    "FormatError",
    "Recording",
    "RecordingError",
    "Writer",
    "check_writable",
    "open_writer",
    "read",
]


class _OpenWriter(Protocol):
    def __call__(self, path: Path, width: int, height: int, *, overwrite: bool) -> Writer: ...


_FORMATS: dict[str, tuple[str, _OpenWriter, Callable[[Path], Recording]]] = {
    ".npz": (npz.DESCRIPTION, npz.NpzWriter, npz.read_npz),
    ".txt": (txt.DESCRIPTION, txt.TxtWriter, txt.read_txt),
    ".csv": (csv.DESCRIPTION, csv.CsvWriter, csv.read_csv),
    ".raw": (raw.DESCRIPTION, raw.RawWriter, raw.read_raw),
    ".aedat4": (aedat4.DESCRIPTION, aedat4_writer.Aedat4Writer, aedat4.read_aedat4),
}

# Other people's: read only.
_READERS: dict[str, tuple[str, Callable[[Path], Recording]]] = {
    ".h5": (hdf5.DESCRIPTION, hdf5.read_hdf5),
    ".hdf5": (hdf5.DESCRIPTION, hdf5.read_hdf5),
    ".bag": (rosbag.DESCRIPTION, rosbag.read_bag),
    ".mcap": (rosbag.DESCRIPTION, rosbag.read_bag),
    ".db3": (rosbag.DESCRIPTION, rosbag.read_bag),
}

SUFFIXES = {suffix: description for suffix, (description, _, _) in _FORMATS.items()}
"""What each suffix that can be written holds, in a line for `--help`."""

READABLE = SUFFIXES | {suffix: description for suffix, (description, _) in _READERS.items()}
"""The same of each suffix that can be read."""


def open_writer(path: str | Path, *, width: int, height: int, overwrite: bool = False) -> Writer:
    """Begin a recording of a width x height camera, in the format of the path's suffix.

    Raises FormatError for a suffix that is none of SUFFIXES, RecordingError where the file exists already and
    `overwrite` is false, or cannot be made.
    """
    path = Path(path)
    check_writable(path, overwrite=overwrite)
    return _FORMATS[path.suffix.lower()][1](path, width, height, overwrite=overwrite)


def check_writable(path: Path, *, overwrite: bool) -> None:
    """Raises what `open_writer` does for a name that will not do, before there is a camera."""
    suffix = path.suffix.lower()
    if suffix not in _FORMATS:
        what = "can be read, not written" if suffix in READABLE else "is no recording's"
        raise FormatError(f"{path}: the suffix {path.suffix!r} {what}: choose {_listed(SUFFIXES)}")
    if path.exists() and not overwrite:
        raise exists_already(path)


def read(path: str | Path) -> Recording:
    """Read a recording: a file with one of READABLE, an unfinished FILE.npz.partial, an Event Camera Dataset
    folder (events.txt, images.txt) or a ROS 2 bag folder (metadata.yaml).

    Raises FormatError for anything else, naming what is wrong where; RecordingError where it cannot be read.
    Compressed AEDAT4, HDF5 and bags take the extra [lab].
    """
    path = Path(path)
    try:
        path.stat()  # one that is not there is no matter of formats
        with whole(path):
            recording = _reader_of(path)(path)
    except OSError as error:
        reason = error.strerror or "it is damaged"
        raise RecordingError(f"{path} cannot be read: {reason}: check the name and its rights") from error
    if max(recording.width, recording.height) > LONGEST_SIDE:
        raise FormatError(f"{path} says {recording.width}x{recording.height} pixels: no sensor has so many")
    fault = fault_in(recording.events, recording.width, recording.height)
    if fault:
        raise FormatError(f"{path}, {fault}")
    return recording


def _reader_of(path: Path) -> Callable[[Path], Recording]:
    if path.suffix == npz.PARTIAL:
        return spool.read_spool
    if path.is_dir():
        return _folder_reader(path)
    suffix = path.suffix.lower()
    if suffix in _FORMATS:
        return _FORMATS[suffix][2]
    if suffix in _READERS:
        return _READERS[suffix][1]
    raise FormatError(f"{path}: no recording has the suffix {path.suffix!r}: choose {_listed(READABLE)}")


def _folder_reader(path: Path) -> Callable[[Path], Recording]:
    if (path / "events.txt").exists():
        return txt.read_folder
    if (path / rosbag.METADATA).exists():
        return rosbag.read_bag
    raise FormatError(
        f"{path} is a folder without an events.txt: give a recording, or a folder with events.txt "
        f"or a ROS 2 bag's {rosbag.METADATA}"
    )


def _listed(formats: dict[str, str]) -> str:
    return "; ".join(f"{suffix} ({description})" for suffix, description in formats.items())
