"""What a camera file has and the recording does not show.

Base parameters are fitted and what is missing is looked for, but an effect that the file has is taken as it
is. In a preset it may be a guess: half a noise pair a second from each pixel of a camera that gives none.
"""

from voltcam_simulator import Camera, Parameters

from ..session import Session
from .loop import Report
from .model import flat, spread_of
from .robust import gap
from .step import base_fitted
from .trial import COARSE

LESS = 0.8  # of the gap: what is left without them at most, where they are taken out


def own_effects(session: Session) -> tuple[str, ...]:
    """Effects of the catalogue that the camera file has."""
    return tuple(name for name in session.left_out if getattr(session.camera.parameters, name).active)


def without_excess(session: Session, report: Report) -> Camera | None:
    """The camera without its `own_effects`, where the recording is better explained so; else None.

    Only all of them are tried: one that is there is looked for then as any that the file lacks.
    """
    own = own_effects(session)
    if not own:
        return None
    report(f"Are the effects of the camera file in this recording ({', '.join(own)})?")
    given = session.camera.parameters
    bare = given.model_copy(update={name: type(getattr(given, name))() for name in own})
    with_them, without = (_gap(session, parameters) for parameters in (given, bare))
    out = without < LESS * with_them
    end = "they are taken out, and looked for with the others" if out else "they stay as they are"
    report(f"Gap {with_them:.2f} with them and {without:.2f} without, base parameters fitted: {end}.")
    return session.camera.model_copy(update={"parameters": bare}) if out else None


def _gap(session: Session, parameters: Parameters) -> float:
    """What is left of it in the training parts, base parameters fitted."""
    model = base_fitted(session.rig, session.model_of(parameters), session.data)
    spread = spread_of(session.rig, model, COARSE)
    return gap(flat((session.data - spread.mean) / spread.v))
