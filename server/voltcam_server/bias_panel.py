"""The biases of a running camera: what drivers of a DAVIS set, over the parameters it has."""

import threading
from collections.abc import Mapping
from typing import Any

from voltcam_simulator import Parameters
from voltcam_simulator.biases import Biases, BiasSet, biases_of, changes_for, with_changes


class BiasPanel:
    """Of one camera, whose parameters at the usual biases are `camera`."""

    def __init__(self, camera: Parameters) -> None:
        self._camera = camera
        self._lock = threading.Lock()
        self._last: BiasSet = Biases()

    def now(self, parameters: Parameters) -> BiasSet:
        """The biases of a camera that has these parameters now."""
        with self._lock:
            return biases_of(parameters, self._camera, self._last)

    def wanted(self, parameters: Parameters, changes: Mapping[str, Any]) -> tuple[BiasSet, dict[str, Any]]:
        """The biases of now with changes, and the changes of parameters that go with the biases changed.

        Raises pydantic.ValidationError.
        """
        biases = with_changes(self.now(parameters), changes)
        named = {name.partition("_")[0] for name in changes}
        return biases, {
            effect: {key: value for key, value in values.items() if named & BY_PARAMETER[key]}
            for effect, values in changes_for(biases, self._camera).items()
        }

    def set(self, biases: BiasSet) -> None:
        """They have been set."""
        with self._lock:
            self._last = biases


BY_PARAMETER = {
    "theta_on": {"ONBn", "DiffBn"},
    "theta_off": {"OFFBn", "DiffBn"},
    "period_us": {"RefrBp"},
    "cutoff_hz": {"PrBp"},
    "follower_hz": {"PrSFBp"},
}
"""Which biases a parameter depends on: the others leave it as a slider has set it."""
