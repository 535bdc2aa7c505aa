"""Runs of the rig that are kept on disk, so that a diagnosis can be interrupted and goes on from there."""

import hashlib
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import CancelledError, ThreadPoolExecutor, as_completed
from contextlib import suppress
from functools import cached_property
from pathlib import Path

import numpy as np

from voltcam_simulator import Parameters
from voltcam_simulator.kernel import CACHE_FOLDER

from ...statistics import Setting, Values
from .rig import Events, Item, Job, Made, Rig
from .settings import DEFAULT_RIG, RigSettings
from .workers import Workers

_SEEDS_APART = 1 << 20  # a multiple of how many versions of light there are: a seed's remainder chooses

Batch = Callable[[int], None]
Done = Callable[[int], None]


class StoredRig(Rig):
    """A rig that keeps what it saw of each run in `folder`, and takes it from there when asked again.

    batch(n): n runs begin; done(n): n of them have ended. Seeds of runs are moved by `seed`. processes: more
    than one are workers beside this one.
    """

    def __init__(
        self, setting: Setting, folder: Path, seed: int = 0, settings: RigSettings = DEFAULT_RIG,
        batch: Batch = lambda _: None, done: Done = lambda _: None, processes: int = 1,
    ) -> None:  # fmt: skip
        super().__init__(setting, settings)
        self.batch, self.done, self._processes = batch, done, processes
        self._folder, self._seed = folder, seed
        self._ended = threading.Event()  # by an error or Ctrl-C
        self._digest = _digest(setting, settings)
        folder.mkdir(parents=True, exist_ok=True)

    def events(
        self, parameters: Parameters, seeds: Sequence[int], apart: bool = False, noisier: bool = False
    ) -> list[Events]:
        """The events of each run of a batch."""
        return super().events(parameters, self._own(seeds), apart, noisier)

    def run(
        self, parameters: Parameters, seeds: Sequence[int], apart: bool = False, noisier: bool = False
    ) -> Values:
        """(seeds, PARTS, n) statistics of a batch of runs, comparable."""
        if self._ended.is_set():
            raise CancelledError
        key = f"{self._digest} {self._seed} {list(seeds)} {apart} {noisier} {parameters.model_dump_json()}"
        path = self._folder / f"{hashlib.sha256(key.encode()).hexdigest()[:32]}.npy"
        values = _read(path)
        if values is None:
            workers = self._workers
            values = (
                super().run(parameters, seeds, apart, noisier)
                if workers is None
                else workers.run(parameters, self._own(seeds), apart, noisier)
            )
            partial = path.with_suffix(f".{threading.get_ident()}.partial")
            with partial.open("wb") as file:
                np.save(file, values)
            partial.replace(path)
        return values

    def runs(
        self, many: Sequence[Parameters], seeds: Sequence[int], apart: bool = False, noisier: bool = False
    ) -> list[Values]:
        """Of each parameter set, (seeds, PARTS, n): all runs."""
        self.batch(len(many) * len(seeds))
        return super().runs(many, seeds, apart, noisier)

    def remembered(self, job: Job) -> Values:
        """What `run` gives, which counts as done also where it was asked for before."""
        values = super().remembered(job)
        self.done(len(job[1]))
        return values

    @cached_property
    def _workers(self) -> Workers | None:
        return Workers(self, self._folder, self._processes) if self._processes > 1 else None

    def each(self, function: Callable[[Item], Made], items: Sequence[Item]) -> list[Made]:
        """The function, which asks for runs, of each item; as many at a time as there are processes."""
        if self._workers is None or len(items) < 2:
            return super().each(function, items)
        with ThreadPoolExecutor(self._processes) as pool:  # they wait for the workers
            jobs = [pool.submit(function, item) for item in items]
            try:
                for job in as_completed(jobs):
                    job.result()
            except BaseException:
                self._ended.set()  # else all that they have begun would be run first
                raise
            return [job.result() for job in jobs]

    def _own(self, seeds: Sequence[int]) -> list[int]:
        return [seed + _SEEDS_APART * self._seed for seed in seeds]

    def end(self) -> None:
        """Let the workers go, if there are any; what is on disk stays."""
        workers = self.__dict__.get("_workers")
        if workers is not None:
            workers.end()

    def forget(self) -> None:
        """Let the workers go, and remove what they and this have put on disk; the folder, if that was all."""
        self.end()
        for pattern in ("*.npy", "*.partial", "*.arrays"):
            for path in self._folder.glob(pattern):
                path.unlink(missing_ok=True)
        with suppress(OSError):
            self._folder.rmdir()


def _digest(setting: Setting, settings: RigSettings) -> str:
    """Of all that a run depends on, beside parameters and seed."""
    scene, digest = setting.scene, hashlib.sha256(CACHE_FOLDER.name.encode())
    for array in (
        scene.taken,
        scene.taken_us,
        scene.images,
        scene.t_us,
        setting.pixels,
        setting.frame_starts_us,
    ):
        digest.update(np.ascontiguousarray(array).tobytes())
    digest.update(setting.parameters.model_dump_json().encode())
    digest.update(repr(settings).encode())
    for source in sorted(Path(__file__).parents[1].rglob("*.py")):
        digest.update(source.read_bytes())
    return digest.hexdigest()


def _read(path: Path) -> Values | None:
    try:
        return np.asarray(np.load(path), np.float64)
    except (OSError, ValueError, EOFError):  # not there, or cut off
        return None
