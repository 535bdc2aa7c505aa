"""Which camera a diagnosis gives: what was fitted where light is known has to hold where it is not.

Light between frames may be known of one event in a hundred, where hardly anything moves. Base parameters
fitted to these made the rest of a street worse: decision 37. So what was fitted is held against the camera
file by all events.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from voltcam_simulator import Camera, Parameters

from ..catalogue.entries import event_delay_us
from ..residual.fit import GenericTerm
from ..rig.clock import counted_from
from ..rig.whole import WholeSensor
from ..search.hypothesis import BASE
from ..search.loop import Diagnosis
from ..search.state import Say
from ..session import Session, missing_in
from .result import AcceptedFile, Way

RUNS = 3
"""Of each way: by chance one in 20 has all of its own nearer than all of another."""


@dataclass(frozen=True)
class Accepted:
    """The parameters that are chosen; difference: of each way, the mean of its runs."""

    parameters: Parameters
    way: Way
    difference: Mapping[Way, float]

    def sentence(self) -> str:
        """What was chosen, and why."""
        each = "".join(f" It is {value:.2f} {_WORDS[way]}." for way, value in self.difference.items())
        return (
            " How far all pixels' events are from the recorded, in any light (0: the same)."
            f"{each} So {_CHOSEN[self.way]}."
        )

    def record(self) -> AcceptedFile:
        """For machines."""
        return AcceptedFile(way=self.way, difference=dict(self.difference))


_WORDS: dict[Way, str] = {
    "fitted": "with what was fitted",
    "found added": "with what was found added to the camera file",
    "as it was": "with the camera file as it was",
}
_CHOSEN: dict[Way, str] = {
    "fitted": "the new file has what was fitted",
    "found added": "the new file is the one that was given, with what was found added",
    "as it was": "the new file is the one that was given",
}


def accepted(sensor: WholeSensor, given: Parameters, fitted: Parameters, named: bool, say: Say) -> Accepted:
    """What was fitted, the given file with what was found added, or the given file.

    Base parameters and what is taken out rest on known light only. So a file with what was found added has
    both from the given file.

    Where effects were named they are tried in this order, else the given file comes first. The next takes the
    place of the one before if each of its runs is nearer to the recording than all of that one.
    """
    say("Which camera file is nearest by all pixels, in any light?")
    kept: dict[str, dict[str, Any]] = {effect: {} for effect, _ in BASE}
    for effect, name in BASE:
        kept[effect][name] = getattr(getattr(given, effect), name)
    for effect in missing_in(fitted, given):
        kept[effect] = getattr(given, effect).model_dump()
    ways: dict[Way, Parameters] = {"fitted": fitted}
    added = fitted.changed(kept)
    if late_us := round(event_delay_us(added) - event_delay_us(fitted)):
        # What was found by its stamps acts sooner where a delay is back that it was found without.
        added = counted_from(fitted, late_us).changed(kept)
    if added not in (fitted, given):
        ways["found added"] = added
    if given != fitted:
        ways["as it was"] = given
    runs: dict[Way, list[float]] = {
        way: [sensor.difference(one, run) for run in range(RUNS)] for way, one in ways.items()
    }
    nearest: Way = "fitted" if named or given == fitted else "as it was"
    for way in ways:
        if max(runs[way]) < min(runs[nearest]):
            nearest = way
    return Accepted(ways[nearest], nearest, {way: sum(each) / RUNS for way, each in runs.items()})


def fitted(diagnosis: Diagnosis, generic: Sequence[GenericTerm] = ()) -> Parameters:
    """All that was fitted, on the diagnosis' clock."""
    return generic[-1].parameters if generic else diagnosis.hypothesis.parameters()


def camera_of(session: Session, parameters: Parameters) -> Camera:
    """The camera file with these parameters of the diagnosis, of the recording's size."""
    found = counted_from(parameters, -session.origin_us)
    return session.camera.model_copy(update={"parameters": found})
