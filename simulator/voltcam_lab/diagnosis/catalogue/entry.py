"""What a catalogue entry says: all that a diagnosis knows of one effect."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from voltcam_simulator import Parameters
from voltcam_simulator.effect import Events

from .candidate import Candidate
from .clues import Clues


class SceneSimulator(Protocol):
    """What simulates a camera on the light of the recording (`rig.Rig`)."""

    def events(self, parameters: Parameters, seeds: Sequence[int], apart: bool = False) -> list[Events]:
        """The events of a run for each seed."""
        ...

    def in_trusted_light(self, events: Events) -> Events:
        """Those events that come where the light is known well enough."""
        ...


def _never(parameters: Parameters) -> bool:
    return False


def _zero(parameters: Parameters) -> int:
    return 0


def _nothing(parameters: Parameters, t_us: int) -> dict[str, Any]:
    return {}


def _as_it_is(rig: SceneSimulator, parameters: Parameters, candidate: Candidate, events: Events) -> Candidate:
    return candidate


@dataclass(frozen=True)
class Entry:
    """An effect in the catalogue. The defaults suit an effect without a clock or a place of its own.

    effect: its name in the registry.
    best_shown_by: the recording that tells it from others, as in "record: ...".
    candidates: the forms in which it is looked for. None are given for what only the open route adds.
    in_words: its name in a sentence; empty: the registry's name.
    needs_all_columns: it shows only where the whole width of the sensor is looked at.
    acts_across_columns: whether, in a camera, the columns of the sensor share it. Such a camera is not
        simulated several times side by side on one wide sensor.
    lead_in_us: how long a camera must run before the recording begins.
    delay_us: how much later all events come.
    on_clock: the effect's parameters that change when time is counted from t_us.
    tuned: a candidate with fixed parameters measured from the events of the recording.
    """

    effect: str
    best_shown_by: str
    candidates: Callable[[Clues], tuple[Candidate, ...]] = lambda clues: ()
    in_words: str = ""
    needs_all_columns: bool = False
    acts_across_columns: Callable[[Parameters], bool] = _never
    lead_in_us: Callable[[Parameters], int] = _zero
    delay_us: Callable[[Parameters], float] = _zero
    on_clock: Callable[[Parameters, int], Mapping[str, Any]] = _nothing
    tuned: Callable[[SceneSimulator, Parameters, Candidate, Events], Candidate] = _as_it_is
