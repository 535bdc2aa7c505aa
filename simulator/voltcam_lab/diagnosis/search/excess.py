"""What a camera file has and the recording does not show.

Base parameters are fitted and what is missing is looked for, but an effect that the file has is taken as it
is. In a preset it may be a guess: half a noise pair a second from each pixel of a camera that gives none.
"""

from voltcam_simulator import Camera, Parameters

from ..session import Session
from .hypothesis import start_of
from .robust import mean_huber
from .spread import flat, spread_of
from .state import Search
from .step import base_fitted


def own_effects(session: Session) -> tuple[str, ...]:
    """Effects of the catalogue that the camera file has."""
    return tuple(name for name in session.left_out if getattr(session.camera.parameters, name).active)


def without_excess(session: Session, search: Search) -> Camera | None:
    """The camera without its `own_effects`, where the recording is better explained so; else None.

    Only all of them are tried: one that is there is looked for then as any that the file lacks.
    """
    own = own_effects(session)
    if not own:
        return None
    search.say(f"Are the effects of the camera file in this recording ({', '.join(own)})?")
    given = session.camera.parameters
    bare = given.model_copy(update={name: type(getattr(given, name))() for name in own})
    with_them, without = (_gap(search, session.on_clock(parameters)) for parameters in (given, bare))
    out = without < search.settings.taken_out_below * with_them
    end = "they are taken out, and looked for with the others" if out else "they stay as they are"
    search.say(f"Gap {with_them:.2f} with them and {without:.2f} without, base parameters fitted: {end}.")
    return session.camera.model_copy(update={"parameters": bare}) if out else None


def _gap(search: Search, parameters: Parameters) -> float:
    """What is left of it in the training parts, base parameters fitted."""
    hypothesis, settings = base_fitted(search, start_of(parameters, search.settings)), search.settings
    spread = spread_of(search.rig, hypothesis, settings.runs.rough_twins, settings)
    return mean_huber(flat((search.data - spread.mean) / spread.sd), settings.huber_z)
