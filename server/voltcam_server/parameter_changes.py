"""Parameters as they change while a camera runs: asked for in any thread, taken on between two intervals."""

import threading
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from voltcam_simulator import Parameters, Simulator
from voltcam_simulator.fixed_pattern import FixedPattern


class _Laid(NamedTuple):
    """The newest pattern, None at first; version: of its parameters, gamma: of what it is for."""

    pattern: FixedPattern | None
    version: int
    gamma: float


class ParameterChanges:
    """Those of one simulator. Versions count from 0, the parameters that it was made with.

    The simulator has them as its source's grey levels need them, see `Parameters.seen_through`.
    """

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._lock = threading.Lock()
        self._wanted = (simulator.parameters, 0)
        self._laying = threading.Lock()
        self._gamma = 1.0  # of what the sensor is shown
        self._laid = self._taken = _Laid(None, 0, 1.0)
        self.version = 0
        """Of the parameters that the simulator has now."""

    @property
    def newest(self) -> tuple[Parameters, int]:
        """The newest parameters and their version; they hold from the next interval on."""
        with self._lock:
            return self._wanted

    def change(self, changes: Mapping[str, Any]) -> tuple[Parameters, int]:
        """Change parameters, all at once, from the next interval on; returns them and their version.

        Raises pydantic.ValidationError, with nothing changed.
        """
        with self._lock:
            parameters, version = self._wanted
            mine = self._wanted = parameters.changed(changes), version + 1
        self._lay_down(mine[1])
        return mine

    def _lay_down(self, version: int) -> None:
        """Have the sensor's pattern made for this version or a newer one: a moving slider has few made."""
        with self._laying:
            gamma = self._gamma
            if self._laid.version < version or self._laid.gamma != gamma:
                parameters, newest = self.newest
                pattern = self._simulator.laid_down(parameters.seen_through(gamma))
                self._laid = _Laid(pattern, newest, gamma)

    def take(self, gamma: float | None = None, before: Callable[[], None] = lambda: None) -> None:
        """Give the simulator the newest pattern that is made. For the thread that calls `advance`.

        gamma: of the frame that comes next; None: as it was. before: called before there is a change.
        """
        if gamma is not None and gamma != self._gamma:
            self._gamma = gamma
            self._lay_down(self._laid.version)
        laid = self._laid
        if laid is not self._taken:
            assert laid.pattern is not None
            before()
            self._simulator.take(laid.pattern)
            self._taken, self.version = laid, laid.version
