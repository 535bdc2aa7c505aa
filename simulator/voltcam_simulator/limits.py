"""Where an interval may be given up: bounds that whoever calls the simulator sets."""

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass


class GivenUpError(Exception):
    """An interval was left on the way to its end."""


class TooManyEventsError(GivenUpError):
    """It has more events than it may have."""


class TooLongError(GivenUpError):
    """Its making takes longer than it may."""


def _never() -> bool:
    return False


@dataclass(frozen=True, slots=True)
class Limits:
    """Of the work on one interval.

    - `coarser`: how many times longer than effects ask steps may be, where time is too short for all of them.
    - `most_events`: that may be there at any stage from the pixels to the user.
    - `late`: asked now and then from several threads; True gives the interval up.
    """

    coarser: float = 1.0
    most_events: int = sys.maxsize
    late: Callable[[], bool] = _never

    def __post_init__(self) -> None:
        if not 1 <= self.coarser < math.inf:
            raise ValueError(
                f"steps {self.coarser} times as long as effects ask are not possible: give 1 or more"
            )

    def admit(self, count: float) -> None:
        """Raises TooManyEventsError where there are more than may be."""
        if count > self.most_events:
            raise TooManyEventsError

    def hurry(self) -> None:
        """Raises TooLongError where it is late."""
        if self.late():
            raise TooLongError
