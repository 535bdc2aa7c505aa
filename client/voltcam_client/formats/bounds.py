"""Files that are not what they say: sizes are checked before memory is taken for them."""

import contextlib
import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from voltcam_client.errors import VoltcamError
from voltcam_client.formats.recording import FormatError

MOST_SWELL = 250  # how much larger than its file a recording may be; dark frames compress best
SMALL_BYTES = 1 << 26  # so much may be in the smallest file

_HEADERS = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}


def fits(path: Path, size_bytes: int) -> None:
    """Whether a file may hold so much. Raises FormatError."""
    if size_bytes > SMALL_BYTES + MOST_SWELL * path.stat().st_size:
        raise FormatError(
            f"{path} says that it holds {size_bytes:.2g} bytes, which is more than it can: copy it again"
        )


def check_arrays(path: Path, archive: zipfile.ZipFile) -> None:
    """Each array of an .npz is as large as its header says. Raises FormatError."""
    total = 0
    for info in archive.infolist():
        if not info.filename.endswith(".npy"):
            continue
        with archive.open(info) as file:
            version = np.lib.format.read_magic(file)
            if version not in _HEADERS:
                raise FormatError(
                    f"{path}: array {info.filename} has a version that is not known: save it again"
                )
            shape, _, dtype = _HEADERS[version](file)
        size = dtype.itemsize
        for side in shape:
            size *= int(side)  # Python's numbers do not overflow
        if size > info.file_size:
            raise FormatError(f"{path} is cut short or damaged: copy or record it again")
        total += size
    fits(path, total)


@contextlib.contextmanager
def whole(path: Path) -> Iterator[None]:
    """What a reader stumbles over in a file as a FormatError of one line, without anything of its content."""
    try:
        yield
    except (VoltcamError, OSError):
        raise
    except Exception as error:  # of numpy, zipfile, json, struct: each has its own
        raise FormatError(
            f"{path} is damaged or no such file ({type(error).__name__}): copy it again"
        ) from error
    except BaseException as error:  # how a library written in Rust says that it has given up
        if type(error).__name__ != "PanicException":
            raise
        raise FormatError(f"{path} is damaged: copy or record it again") from None
