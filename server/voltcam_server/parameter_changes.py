"""Parameters as they change while a camera runs: asked for in any thread, taken on between two intervals."""

import threading
from collections.abc import Mapping
from typing import Any

from voltcam_simulator import Parameters, Simulator
from voltcam_simulator.fixed_pattern import FixedPattern


class ParameterChanges:
    """Those of one simulator. Versions count from 0, the parameters that it was made with."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._lock = threading.Lock()
        self._wanted = (simulator.parameters, 0)
        self._laying = threading.Lock()
        self._laid: tuple[FixedPattern | None, int] = (None, 0)  # newest pattern and its version
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
            if self._laid[1] < version:
                parameters, newest = self.newest
                self._laid = self._simulator.laid_down(parameters), newest

    def take(self) -> None:
        """Give the simulator the newest pattern that is made. For the thread that calls `advance`."""
        pattern, version = self._laid
        if pattern is not None and version != self.version:
            self._simulator.take(pattern)
            self.version = version
