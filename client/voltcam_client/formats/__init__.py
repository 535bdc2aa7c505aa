"""Recordings on disk, one file here per format; the suffix says which.

    with open_writer("out.npz", width=346, height=260) as writer:
        writer.events(events)
    recording = read("out.npz")

What goes wrong with names and contents is a FormatError, with the disk a RecordingError; both are one line to
show to the user.
"""

from collections.abc import Callable
from pathlib import Path

from voltcam_client.formats import (
    aedat2,
    aedat4,
    aedat4_writer,
    csv,
    dat,
    es,
    evt2,
    hdf5,
    hdf5_writer,
    npz,
    raw,
    rosbag,
    rosbag_writer,
    spool,
    txt,
)
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
    "left_out",
    "open_writer",
    "read",
    "suffix_of",
]


_FORMATS: dict[str, tuple[str, type[Writer], Callable[[Path], Recording]]] = {
    ".npz": (npz.DESCRIPTION, npz.NpzWriter, npz.read_npz),
    ".txt": (txt.DESCRIPTION, txt.TxtWriter, txt.read_txt),
    ".csv": (csv.DESCRIPTION, csv.CsvWriter, csv.read_csv),
    ".raw": (raw.DESCRIPTION, raw.RawWriter, raw.read_raw),
    ".aedat4": (aedat4.DESCRIPTION, aedat4_writer.Aedat4Writer, aedat4.read_aedat4),
    ".evt2.raw": (evt2.DESCRIPTION, evt2.Evt2Writer, raw.read_raw),
    ".dat": (dat.DESCRIPTION, dat.DatWriter, dat.read_dat),
    ".es": (es.DESCRIPTION, es.EsWriter, es.read_es),
    ".h5": (hdf5.DESCRIPTION, hdf5_writer.Hdf5Writer, hdf5.read_hdf5),
    ".hdf5": (hdf5.DESCRIPTION, hdf5_writer.Hdf5Writer, hdf5.read_hdf5),
    **{
        f"{messages}{suffix}": (f"{kind}, {what}", rosbag_writer.BagWriter, rosbag.read_bag)
        for suffix, kind in rosbag.KINDS.items()
        for messages, what in rosbag_writer.MESSAGES.items()
    },
}

# Other people's: read only.
_READERS: dict[str, tuple[str, Callable[[Path], Recording]]] = {
    ".aedat": (aedat2.DESCRIPTION, aedat2.read_aedat2),
}

SUFFIXES = {suffix: description for suffix, (description, _, _) in _FORMATS.items()}
"""What each suffix that can be written holds, in a line for `--help`."""

READABLE = SUFFIXES | {suffix: description for suffix, (description, _) in _READERS.items()}
"""The same of each suffix that can be read."""


def suffix_of(path: Path) -> str:
    """What says the format: the longest of READABLE that the name ends with ('.evt2.raw' before '.raw'), else
    whatever the name ends with."""
    ends = (suffix for suffix in READABLE if path.name.lower().endswith(suffix) and path.name[: -len(suffix)])
    return max(ends, key=len, default=path.suffix.lower())


def left_out(path: Path, *, frames: bool = True) -> str:
    """What the format of `path` cannot carry, for who records into it, in words; empty where it carries all.

    frames: whether there will be some.
    """
    suffix = suffix_of(path)
    writer = _FORMATS[suffix][1]
    lost = [
        *(["frames"] if frames and not writer.holds_frames else []),
        *([] if writer.holds_time_of_day else ["the time of day"]),
    ]
    return f"without {' and '.join(lost)}, which {suffix} cannot carry" if lost else ""


def open_writer(path: str | Path, *, width: int, height: int, overwrite: bool = False) -> Writer:
    """Begin a recording of a width x height camera, in the format of the path's suffix.

    Raises FormatError for a suffix that is none of SUFFIXES, RecordingError where the file exists already and
    `overwrite` is false, or cannot be made.
    """
    path = Path(path)
    check_writable(path, overwrite=overwrite)
    return _FORMATS[suffix_of(path)][1](path, width, height, overwrite=overwrite)


def check_writable(path: Path, *, overwrite: bool) -> None:
    """Raises what `open_writer` does for a name that will not do, before there is a camera."""
    suffix = suffix_of(path)
    if suffix not in _FORMATS:
        what = "can be read, not written" if suffix in READABLE else "is no recording's"
        raise FormatError(f"{path}: the suffix {suffix!r} {what}: choose {_listed(SUFFIXES)}")
    if path.exists() and not overwrite:
        raise exists_already(path)


def read(path: str | Path) -> Recording:
    """Read a recording: a file with one of READABLE, an unfinished FILE.partial, an Event Camera Dataset
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
    if path.suffix == spool.PARTIAL:
        return spool.read_spool
    if path.is_dir():
        return _folder_reader(path)
    suffix = suffix_of(path)
    if suffix in _FORMATS:
        return _FORMATS[suffix][2]
    if suffix in _READERS:
        return _READERS[suffix][1]
    raise FormatError(f"{path}: no recording has the suffix {suffix!r}: choose {_listed(READABLE)}")


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
