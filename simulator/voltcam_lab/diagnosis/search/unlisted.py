"""The open route: a gap that no listed effect explains, said as a drift or a noise of unknown mechanism."""

from dataclasses import dataclass

from voltcam_simulator import Parameters

from ..catalogue.candidate import Candidate
from .hypothesis import Hypothesis
from .settings import SearchSettings
from .settings_proof import OpenRoute
from .state import Search
from .step import SearchStep, step_of, with_trials
from .trial import Trial


@dataclass(frozen=True, eq=False)
class ResidualTerm:
    """The form that held-out data confirm, the hypothesis with it, and the forms that do as well."""

    trial: Trial
    formula: str
    others: tuple[str, ...]
    step: SearchStep

    @property
    def hypothesis(self) -> Hypothesis:
        """With the term added."""
        return self.trial.hypothesis


def forms(parameters: Parameters, route: OpenRoute, whole: bool = True) -> tuple[Candidate, ...]:
    """Drifts and noises as powers of brightness, drifts that grow over the image; of about the size of what
    is there already. whole: of all columns; what grows across them cannot be seen in strips."""
    leak = parameters.junction_leak.k4_per_us + 128 * parameters.parasitic_photocurrent.k5_per_dn_us
    sigma = parameters.photon_noise.k3 * 128**0.5 / 148 + parameters.leak_noise.k6
    sizes = [way * size * leak for size in route.leaks for way in (1, -1)]
    drifts = [
        Candidate("residual_drift", ("per_us",), tuple((size,) for size in sizes), {"power": power})
        for power in route.powers
    ]
    edges = tuple((size / route.steepness,) for size in sizes)
    slopes = [
        Candidate("residual_drift", ("per_us",), edges, {"power": 0.0, name: route.steepness})
        for name in (("across", "down") if whole else ("down",))
    ]
    variance = ((route.noise_variance * sigma**2,),)
    noises = [
        Candidate("residual_noise", ("variance_per_us",), variance, {"power": power})
        for power in route.powers
    ]
    return (*drifts, *slopes, *noises)


def residual_step(search: Search, hypothesis: Hypothesis) -> SearchStep:
    """A step of the search over the forms instead of the catalogue."""
    tried = forms(hypothesis.parameters(), search.settings.open_route, search.whole)
    return with_trials(search, step_of(search, hypothesis, tried))


def residual_of(settings: SearchSettings, step: SearchStep, confirmed: Trial) -> ResidualTerm:
    """What such a step found, with the trial that held-out data confirm."""
    return ResidualTerm(confirmed, formula_of(confirmed), tied_forms(settings, step, confirmed), step)


def formula_of(trial: Trial) -> str:
    """The term as a formula."""
    parameters = trial.hypothesis.parameters()
    if trial.candidate.effect == "residual_noise":
        noise = parameters.residual_noise
        return f"sigma^2 += {noise.variance_per_us:.3g}/us {_brightness(noise.dark_dn, noise.power)}"
    drift = parameters.residual_drift
    places = [f" (1 + {value:g} {axis})" for value, axis in ((drift.across, "u"), (drift.down, "v")) if value]
    return f"drift += {drift.per_us:.3g}/us {_brightness(drift.dark_dn, drift.power)}" + "".join(places)


def _brightness(dark_dn: float, power: float) -> str:
    return f"((L + {dark_dn:g})/{128 + dark_dn:g})^{power:g}"


def tied_forms(settings: SearchSettings, step: SearchStep, best: Trial) -> tuple[str, ...]:
    """Forms whose score is no worse than the best one's by `Proof.tied`, beside it, in words."""
    top = max(float(step.scores.max()), 0.0)
    names = []
    for score, one in zip(step.scores, step.screen.signatures, strict=True):
        same = one.candidate.effect == best.candidate.effect and one.candidate.others == best.candidate.others
        if top - score < settings.proof.tied and not same:
            names.append(_in_words(one.candidate))
    return tuple(dict.fromkeys(names))


def _in_words(candidate: Candidate) -> str:
    kind = "noise" if candidate.effect == "residual_noise" else "drift"
    place = next((name for name in ("across", "down") if name in candidate.others), None)
    return (
        f"{kind} growing {place} the image"
        if place
        else f"{kind} with brightness^{candidate.others['power']:g}"
    )
