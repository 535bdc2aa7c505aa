"""What is in an .npz: headers of its arrays, checked before memory is taken, and arrays row by row."""

import contextlib
import math
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from voltcam_client.formats.bounds import fits
from voltcam_client.formats.recording import FormatError

_READERS = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}


@dataclass(frozen=True)
class ArrayHeader:
    """What an array says of itself; `fortran`: its first index runs fastest."""

    shape: tuple[int, ...]
    fortran: bool
    dtype: np.dtype[Any]

    @property
    def bytes(self) -> int:
        """Of all its values; in Python's numbers, which do not overflow."""
        return math.prod((self.dtype.itemsize, *map(int, self.shape)))


def array_names(archive: zipfile.ZipFile) -> list[str]:
    """As np.load has them."""
    return [name.removesuffix(".npy") for name in archive.namelist() if name.endswith(".npy")]


def check_arrays(path: Path, archive: zipfile.ZipFile, names: Sequence[str] | None = None) -> None:
    """These arrays, or all, are as large as they say, and no larger than such a file may hold. Raises
    FormatError; KeyError for one that is not there."""
    total = 0
    for name in array_names(archive) if names is None else names:
        with open_array(path, archive, name) as (header, _):
            pass
        if header.bytes > archive.getinfo(f"{name}.npy").file_size:
            raise FormatError(f"{path} is cut short or damaged: copy or record it again")
        total += header.bytes
    fits(path, total)


@contextlib.contextmanager
def open_array(path: Path, archive: zipfile.ZipFile, name: str) -> Iterator[tuple[ArrayHeader, IO[bytes]]]:
    """An array's header, and its values from their beginning. Raises FormatError for a version that is not
    known, ValueError for what is no array."""
    with archive.open(f"{name}.npy") as file:
        version = np.lib.format.read_magic(file)
        if version not in _READERS:
            raise FormatError(f"{path}: array {name}.npy has a version that is not known: save it again")
        yield ArrayHeader(*_READERS[version](file)), file


def rows(file: IO[bytes], header: ArrayHeader) -> Iterator[NDArray[Any]]:
    """From an open array, one item of the first dimension after the other. ValueError where they end
    before that."""
    size = header.bytes // max(1, header.shape[0])
    for _ in range(header.shape[0]):
        yield np.frombuffer(file.read(size), header.dtype).reshape(header.shape[1:])
