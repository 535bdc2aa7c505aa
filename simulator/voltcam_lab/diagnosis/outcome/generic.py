"""Generic terms for what has no name, in words and for machines."""

from ..residual.fit import GenericTerm, generic_terms
from ..rig.whole import WholeSensor
from ..search.loop import Diagnosis
from ..search.state import Say
from .result import Generic


def terms_left(sensor: WholeSensor, diagnosis: Diagnosis, say: Say) -> tuple[GenericTerm, ...]:
    """Generic terms for what a search has left unknown."""
    remains = diagnosis.remains
    if diagnosis.verdict != "unknown" or remains is None:
        return ()
    return generic_terms(sensor, diagnosis.hypothesis.parameters(), remains, say)


def term_in_words(term: GenericTerm) -> str:
    """A generic term, and what it takes away."""
    before, after = (f"{1000 * max(one.noticed, 0.0):.1f}" for one in (term.before, term.after))
    return (
        f"A term of unknown origin, {term.shape.formula()}, takes away part of that: on the later part of the"
        f" recording, which had no part in its fit, {after} millinats an event are left of {before}."
    )


def generic_of(term: GenericTerm) -> Generic:
    """The same for machines."""
    return Generic(
        name=term.shape.effect, kind=term.shape.kind, formula=term.shape.formula(),
        parameters=term.shape.values(), nats_before=term.before.noticed, nats_after=term.after.noticed,
        sentence=term_in_words(term),
    )  # fmt: skip
