"""Processes that run a rig.

A simulation of few pixels is as much Python as kernels, and one process runs Python on one core at a time:
two threads were a tenth faster than one, two processes are nearly twice as fast.
"""

import pickle
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path

import joblib
import numpy as np
from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]

from voltcam_simulator import Parameters

from ... import pool_worker
from ...statistics import Values
from .rig import Rig

MOST = 12  # batches that the search asks for at a time, mostly; each process takes some 110 MB
_LINE = 64  # bytes of a cache line: where arrays begin

FileSpan = tuple[int, int]
"""Where an array begins and ends in the file."""


def cores() -> int:
    """How many processes are worth while here; a container's share and LOKY_MAX_CPU_COUNT count."""
    return min(int(joblib.cpu_count()), MOST)


class Workers:
    """At most `processes` that run `rig`, whose arrays they share in a file in `folder`."""

    def __init__(self, rig: Rig, folder: Path, processes: int) -> None:
        path = folder / "scene.arrays"
        head, places = _written((rig.setting, rig.settings, rig.lights), path)
        self._pool = ProcessPoolExecutor(
            processes, get_context("spawn"), initializer=_begin, initargs=(path, head, places)
        )

    def run(self, parameters: Parameters, seeds: Sequence[int], apart: bool, noisier: bool) -> Values:
        """As `Rig.run`; from any thread."""
        try:
            return self._pool.submit(_run, parameters, tuple(seeds), apart, noisier).result()
        except BrokenProcessPool as error:
            raise ChildProcessError(
                "a process of the diagnosis was killed: close other programs or look at less (--seconds)"
            ) from error

    def end(self) -> None:
        """What runs now is run to its end."""
        self._pool.shutdown(cancel_futures=True)


def _written(thing: object, path: Path) -> tuple[bytes, list[FileSpan]]:
    """Its arrays written to a file; the rest of it, and where they are."""
    arrays: list[pickle.PickleBuffer] = []
    head, places = pickle.dumps(thing, 5, buffer_callback=arrays.append), list[FileSpan]()
    path.unlink(missing_ok=True)  # of a run before: another process may still be reading it
    with path.open("wb") as file:
        for array in arrays:
            file.write(bytes(-file.tell() % _LINE))
            begin = file.tell()
            file.write(array.raw())
            places.append((begin, file.tell()))
    return head, places


def _read(path: Path, head: bytes, places: Sequence[FileSpan]) -> object:
    whole = np.memmap(path, np.uint8, "r").data
    return pickle.loads(head, buffers=[whole[begin:end] for begin, end in places])


_rig: Rig  # of a worker


def _begin(path: Path, head: bytes, places: Sequence[FileSpan]) -> None:
    global _rig
    pool_worker.begin()
    threadpool_limits(1)  # for good: the order of sums would depend on the number of threads
    _rig = Rig(*_read(path, head, places))  # type: ignore[misc]


def _run(parameters: Parameters, seeds: Sequence[int], apart: bool, noisier: bool) -> Values:
    return _rig.run(parameters, seeds, apart, noisier)
