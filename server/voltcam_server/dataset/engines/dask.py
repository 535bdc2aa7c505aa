"""A Dask cluster that runs already: its scheduler hands items to workers, and again where one dies."""

import threading
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from ...problems import UsageError, one_line
from ..clips import Item
from ..item import ItemOutcome, failure
from .engine import KILLED, MOST_DEATHS, Engine, EngineGoneError, Work
from .one_thread import use_one_thread_here

PREFIX = "dask://"
CONNECT_S = 20.0
LOOK_S = 1.0
WITHOUT_WORKERS_S = 120.0  # such as where all are restarted


class DaskEngine(Engine):
    """Client of the scheduler at dask://HOST:PORT. Raises UsageError."""

    def __init__(self, address: str) -> None:
        try:
            import distributed
        except ImportError as error:
            raise UsageError(f"--engine dask:// needs pip install 'voltcam[cluster]' ({error})") from None
        if not address.startswith(PREFIX):
            raise UsageError(f"--engine {address}: give local, or {PREFIX}HOST:PORT of a Dask scheduler")
        self._distributed: Any = distributed
        self._address = address
        try:
            self._client: Any = self._distributed.Client(
                address.replace(PREFIX, "tcp://", 1), timeout=CONNECT_S
            )
        except (OSError, ValueError) as error:
            raise UsageError(f"{address}: no Dask scheduler answers: {one_line(error)}") from None
        if not self._threads():
            self.close()
            raise UsageError(f"{address}: it has no workers: start some, dask worker HOST:PORT --nthreads 1")

    @property
    def workers(self) -> int:
        return self._threads()

    def check(self, folder: Path) -> None:
        seen = self._client.run(_sees, str(folder))
        blind = sorted(worker for worker, sees in seen.items() if not sees)
        if blind:
            raise UsageError(f"{blind[0]} does not see {folder}: give a folder that all workers share")

    def run(self, work: Work, items: Iterable[Item], stop: threading.Event) -> Iterator[ItemOutcome]:
        blamed = list[Item]()
        for item, outcome in self._together(work, items, stop):
            if outcome is None:
                blamed.append(item)
            else:
                yield outcome
        for item in blamed:
            # Dask blames all that waited at a worker that died. Alone, only what kills it is blamed.
            for _, outcome in self._together(work, [item], stop):
                yield outcome or failure(item, KILLED.format(times=MOST_DEATHS + 1))

    def close(self) -> None:
        """What was handed out and has not begun is taken back."""
        self._client.close()

    def _together(
        self, work: Work, items: Iterable[Item], stop: threading.Event
    ) -> Iterator[tuple[Item, ItemOutcome | None]]:
        """As many at a time as there are workers. No outcome where too many workers died with the item."""
        waiting, running = iter(items), dict[Any, Item]()
        seen_s = time.monotonic()
        while True:
            workers = self._threads()
            # As many again wait at the workers, so that none waits for this process.
            while not stop.is_set() and len(running) < 2 * workers:
                item = next(waiting, None)
                if item is None:
                    break
                running[self._client.submit(_do, work, item, pure=False)] = item
            if not running and (workers or stop.is_set()):
                return
            seen_s = time.monotonic() if workers else seen_s
            if time.monotonic() - seen_s > WITHOUT_WORKERS_S:
                raise EngineGoneError(f"{self._address} has had no worker for {WITHOUT_WORKERS_S:.0f} s")
            for future in self._done(running):
                yield running.pop(future), self._outcome(future)

    def _threads(self) -> int:
        try:
            return sum(self._client.nthreads().values())
        except OSError as error:
            raise EngineGoneError(f"{self._address} is gone ({one_line(error)})") from None

    def _done(self, running: dict[Any, Item]) -> list[Any]:
        if not running:
            time.sleep(LOOK_S)
            return []
        try:
            self._distributed.wait(list(running), timeout=LOOK_S, return_when="FIRST_COMPLETED")
        except TimeoutError:
            return []
        return [future for future in running if future.done()]

    def _outcome(self, future: Any) -> ItemOutcome | None:
        try:
            outcome: ItemOutcome = future.result()
        except self._distributed.scheduler.KilledWorker:
            return None
        except (self._distributed.CancelledError, OSError) as error:
            raise EngineGoneError(f"{self._address} is gone ({one_line(error)})") from None
        return outcome


def _do(work: Work, item: Item) -> ItemOutcome:
    use_one_thread_here()
    return work(item)


def _sees(folder: str) -> bool:
    return Path(folder).is_dir()
