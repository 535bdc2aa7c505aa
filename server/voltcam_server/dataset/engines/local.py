"""Processes of this machine, each with one thread."""

import os
import threading
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path

from voltcam_lab import pool_worker

from ..clips import Item
from ..item import ItemOutcome, failure
from .engine import KILLED, MOST_DEATHS, Engine, Work
from .one_thread import ONE_THREAD, use_one_thread_here

LOOK_S = 0.2  # how long a wish to stop may wait


class LocalEngine(Engine):
    """A pool of processes, made anew when one of them was killed.

    A pool does not say which item it was that its process was killed with. So all that were under way are
    then made one at a time.
    """

    def __init__(self, workers: int) -> None:
        self._workers = workers
        self._pool: ProcessPoolExecutor | None = None
        self._environment = {name: os.environ.get(name) for name in ONE_THREAD}
        os.environ.update(dict.fromkeys(ONE_THREAD, "1"))  # processes begin with what it is then

    @property
    def workers(self) -> int:
        return self._workers

    def check(self, folder: Path) -> None:
        """This machine sees its own folders."""

    def run(self, work: Work, items: Iterable[Item], stop: threading.Event) -> Iterator[ItemOutcome]:
        waiting = iter(items)
        suspects: list[Item] | None = None
        while suspects is None or suspects:
            suspects = []
            yield from self._together(work, waiting, stop, suspects)
            for item in suspects:
                if stop.is_set():
                    return
                yield self._alone(work, item)

    def close(self) -> None:
        """Kills them: what they make lies aside."""
        pool, self._pool = self._pool, None
        if pool is not None:
            processes = list((pool._processes or {}).values())
            pool.shutdown(wait=False, cancel_futures=True)
            for process in processes:
                process.kill()
        for name, value in self._environment.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value

    def _together(
        self, work: Work, waiting: Iterator[Item], stop: threading.Event, suspects: list[Item]
    ) -> Iterator[ItemOutcome]:
        """As many at a time as there are workers, until there are none, or until one was killed: then those
        that were under way are in `suspects`."""
        running: dict[Future[ItemOutcome], Item] = {}
        while True:
            # One more than there are workers, so that none waits for this process.
            while not (stop.is_set() or suspects) and len(running) <= self.workers:
                item = next(waiting, None)
                if item is None:
                    break
                running[self._submit(work, item)] = item
            if not running:
                break
            done, _ = wait(running, LOOK_S, FIRST_COMPLETED)
            for future in done:
                item = running.pop(future)
                try:
                    yield future.result()
                except BrokenProcessPool:
                    suspects.append(item)
        if suspects:
            self._pool = None

    def _alone(self, work: Work, item: Item) -> ItemOutcome:
        """With the one of before, so often."""
        for _ in range(MOST_DEATHS - 1):
            try:
                return self._submit(work, item).result()
            except BrokenProcessPool:
                self._pool = None
        return failure(item, KILLED.format(times=MOST_DEATHS))

    def _submit(self, work: Work, item: Item) -> Future[ItemOutcome]:
        """A pool that broke since the last one gives a future that says so."""
        if self._pool is None:
            self._pool = ProcessPoolExecutor(self.workers, get_context("spawn"), initializer=_begin)
        try:
            return self._pool.submit(work, item)
        except BrokenProcessPool as error:
            broken: Future[ItemOutcome] = Future()
            broken.set_exception(error)
            return broken


def _begin() -> None:
    pool_worker.begin()
    use_one_thread_here()
