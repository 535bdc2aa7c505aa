"""The open route: a gap that no listed effect explains, said as a drift or a noise of unknown mechanism."""

from dataclasses import dataclass

from voltcam_simulator import Parameters

from ..catalogue.candidate import Candidate
from ..rig.rig import Rig, Values
from .model import Model
from .step import AS_GOOD, Step, step_of
from .trial import Trial

POWERS = (-2.0, -1.0, -0.5, 0.0, 0.5, 1.0)
STEEP = 8.0  # growth over the image, relative to the drift in its middle: nearly none there
LEAKS = (0.25, 2.0)  # drifts in units of the leak, at the edge of those over the image; effects do not scale


@dataclass(frozen=True, eq=False)
class Residual:
    """The form that proved itself on held-out data, the model with it, and the forms that do as well."""

    trial: Trial
    formula: str
    others: tuple[str, ...]
    step: Step

    @property
    def model(self) -> Model:
        """With the term added."""
        return self.trial.model


def forms(parameters: Parameters, whole: bool = True) -> tuple[Candidate, ...]:
    """Drifts and noises as powers of brightness, drifts that grow over the image; of about the size of what
    is there already. whole: of all columns; what grows across them cannot be seen in strips."""
    leak = parameters.junction_leak.k4_per_us + 128 * parameters.parasitic_photocurrent.k5_per_dn_us
    sigma = parameters.photon_noise.k3 * 128**0.5 / 148 + parameters.leak_noise.k6
    sizes = [way * size * leak for size in LEAKS for way in (1, -1)]
    drifts = [
        Candidate("residual_drift", ("per_us",), tuple((size,) for size in sizes), {"power": power})
        for power in POWERS
    ]
    edges = tuple((size / STEEP,) for size in sizes)
    slopes = [
        Candidate("residual_drift", ("per_us",), edges, {"power": 0.0, name: STEEP})
        for name in (("across", "down") if whole else ("down",))
    ]
    noises = [
        Candidate("residual_noise", ("variance_per_us",), ((4 * sigma**2,),), {"power": power})
        for power in POWERS
    ]
    return (*drifts, *slopes, *noises)


def residual_step(rig: Rig, model: Model, data: Values, whole: bool = True) -> Step:
    """A step of the search over the forms instead of the catalogue."""
    return step_of(rig, model, data, forms(model.parameters(), whole))


def residual_of(step: Step, proven: Trial) -> Residual:
    """What such a step found, of which this trial stood its test."""
    return Residual(proven, said(proven), class_of(step, proven), step)


def said(trial: Trial) -> str:
    """The term as a formula."""
    parameters = trial.model.parameters()
    if trial.candidate.effect == "residual_noise":
        noise = parameters.residual_noise
        return f"sigma^2 += {noise.variance_per_us:.3g}/us {_brightness(noise.dark_dn, noise.power)}"
    drift = parameters.residual_drift
    places = [f" (1 + {value:g} {axis})" for value, axis in ((drift.across, "u"), (drift.down, "v")) if value]
    return f"drift += {drift.per_us:.3g}/us {_brightness(drift.dark_dn, drift.power)}" + "".join(places)


def _brightness(dark_dn: float, power: float) -> str:
    return f"((L + {dark_dn:g})/{128 + dark_dn:g})^{power:g}"


def class_of(step: Step, best: Trial) -> tuple[str, ...]:
    """Forms whose score is no worse than the best one's by AS_GOOD, beside it."""
    top = max(float(step.gains.max()), 0.0)
    names = []
    for gain, one in zip(step.gains, step.screen.signatures, strict=True):
        same = one.candidate.effect == best.candidate.effect and one.candidate.others == best.candidate.others
        if top - gain < AS_GOOD and not same:
            names.append(_short(one.candidate))
    return tuple(dict.fromkeys(names))


def _short(candidate: Candidate) -> str:
    kind = "noise" if candidate.effect == "residual_noise" else "drift"
    place = next((name for name in ("across", "down") if name in candidate.others), None)
    return (
        f"{kind} growing {place} the image"
        if place
        else f"{kind} with brightness^{candidate.others['power']:g}"
    )
