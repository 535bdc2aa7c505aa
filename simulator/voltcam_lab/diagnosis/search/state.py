"""What all steps of a search share."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ...statistics import Values
from ..catalogue.candidate import Candidate
from ..rig.rig import Rig
from ..rig.whole import WholeSensor
from ..session import Session
from .settings import DEFAULTS, SearchSettings

Say = Callable[[str], None]
"""Takes a sentence for the user as soon as something is found."""


def _silent(sentence: str) -> None:
    pass


@dataclass(frozen=True, eq=False)
class Search:
    """rig: simulates cameras on the recording's light. data: (PARTS, n) statistics of the recording, as
    `Rig.observe` gives them. candidates: what is looked for. whole: whether the rig has all columns of the
    sensor. sensor: all of these, for what is asked of all pixels; None: nothing is."""

    rig: Rig
    data: Values
    candidates: Sequence[Candidate]
    settings: SearchSettings = DEFAULTS
    say: Say = _silent
    whole: bool = True
    sensor: WholeSensor | None = None


def search_of(session: Session, settings: SearchSettings = DEFAULTS, say: Say = _silent) -> Search:
    """The search of a recording that is made ready."""
    return Search(session.rig, session.data, session.candidates, settings, say, session.whole, session.sensor)
