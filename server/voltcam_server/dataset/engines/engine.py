"""What every engine does."""

import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Self

from ..clips import Item
from ..item import ItemOutcome

Work = Callable[[Item], ItemOutcome]

MOST_DEATHS = 3  # of workers that one item may cost
KILLED = "its process was killed, {times} times: it may need more memory than there is; give fewer --workers"


class EngineGoneError(RuntimeError):
    """One line: there are no workers any more. What is made is kept."""


class Engine(ABC):
    """A context manager."""

    @property
    @abstractmethod
    def workers(self) -> int:
        """That make an item each at a time."""

    @abstractmethod
    def check(self, folder: Path) -> None:
        """Raises UsageError where a worker does not see the set's folder."""

    @abstractmethod
    def run(self, work: Work, items: Iterable[Item], stop: threading.Event) -> Iterator[ItemOutcome]:
        """`work(item)` of each, in the order in which they are done. A worker that dies costs no item: it is
        made again, and one that kills its worker each time has a failure for its outcome.

        After `stop` no other begins; what has begun is brought to its end. Raises EngineGoneError.
        """

    @abstractmethod
    def close(self) -> None:
        """What still runs is ended, and its item not made."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
