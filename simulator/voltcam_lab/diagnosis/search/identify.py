"""What a recording can tell, before anybody looks at its events: base parameters, and sizes of effects."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters

from ..catalogue.candidate import Candidate
from ..rig.rig import Rig
from .hypothesis import BASE, Hypothesis
from .precise import precise
from .screen import Screen, Signature, screen_of
from .settings import DEFAULTS, SearchSettings
from .spread import spread_of

Fixed = Literal["yes", "in part", "no"]
"""Whether a recording fixes a parameter."""


@dataclass(frozen=True)
class ParameterIdentifiability:
    """How well the recording fixes a base parameter. sd: of its logarithm; share: of the camera file's
    uncertainty (variance) that goes; answer: whether it is fixed; mixed_with: others that move with it, and
    their correlation."""

    effect: str
    name: str
    value: float
    sd: float
    share: float
    answer: Fixed
    mixed_with: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class DetectableSize:
    """The smallest size of an effect that would be found; None where none would. ratio: 1 is no effect."""

    effect: str
    name: str
    size: float | None
    unit: str
    ratio: bool = False


@dataclass(frozen=True)
class Identifiability:
    """base, in the order of `hypothesis.BASE`; effects, each at the sign that shows best."""

    base: tuple[ParameterIdentifiability, ...]
    effects: tuple[DetectableSize, ...]

    def text(self) -> str:
        """Lines for a terminal."""
        lines = [
            "What this recording can tell",
            f"  {'parameter':<40}{'fixed':<9}{'known to':<12}mixed up with",
        ]
        for one in self.base:
            name = f"{one.effect}.{one.name}"
            lines.append(f"  {name:<40}{one.answer:<9}{f'+- {percent(one.sd)}':<12}{mixed_up(one)}".rstrip())
        lines.append(f"  {'effect':<40}seen from")
        for effect in self.effects:
            lines.append(f"  {effect.effect + '.' + effect.name:<40}{smallest(effect)}")
        return "\n".join(lines)


def mixed_up(one: ParameterIdentifiability) -> str:
    """Its partners, in words."""
    return ", ".join(f"{name} ({value:+.2f})" for name, value in one.mixed_with.items())


def smallest(one: DetectableSize) -> str:
    """The size with its unit."""
    if one.size is None:
        return "does not show in this recording"
    text = short(abs(one.size), 4 if one.ratio else 2)
    return text if one.unit == "1" else f"{text} {one.unit}"


def percent(share: float) -> str:
    """Small ones with a digit more."""
    return f"{share:.0%}" if share >= 0.0995 else f"{share:.1%}"


def short(number: float, digits: int = 3) -> str:
    """With so many digits that count; with an exponent where it is very large or very small."""
    if number == 0 or not 1e-4 <= abs(number) < 1e6:
        return f"{number:.{digits}g}"
    places = max(digits - 1 - int(np.floor(np.log10(abs(number)))), 0)
    rounded = float(f"{number:.{digits}g}")
    return f"{rounded:.{places}f}"


def identify(
    rig: Rig,
    hypothesis: Hypothesis,
    candidates: Sequence[Candidate],
    settings: SearchSettings = DEFAULTS,
) -> Identifiability:
    """Of a rig's scene, with twins of the hypothesis only: no data are looked at."""
    spread = spread_of(rig, hypothesis, settings.runs.twins, settings)
    screen = screen_of(rig, hypothesis, spread, candidates, settings)
    covariance = precise(rig, hypothesis, spread, settings).covariance
    return Identifiability(base_identifiability(hypothesis, covariance, settings), detectable_sizes(screen))


def base_identifiability(
    hypothesis: Hypothesis, covariance: NDArray[np.float64], settings: SearchSettings
) -> tuple[ParameterIdentifiability, ...]:
    """The base parameters of a hypothesis, with the covariance of its `shift`."""
    k = len(BASE)
    of_all = covariance[:k, :k]
    sd = np.sqrt(np.diag(of_all))
    correlation = of_all / np.outer(sd, sd)
    parameters, prior_sd = hypothesis.parameters(), hypothesis.prior_sd(settings)
    found = []
    for i, (effect, name) in enumerate(BASE):
        mixed = {
            BASE[j][1]: float(correlation[i, j])
            for j in np.argsort(-np.abs(correlation[i]))
            if j != i and abs(correlation[i, j]) > settings.reporting.mixed
        }
        share = 1 - float(sd[i] / prior_sd[i]) ** 2
        value = getattr(getattr(parameters, effect), name)
        answer = answer_of(share, settings)
        found.append(ParameterIdentifiability(effect, name, value, float(sd[i]), share, answer, mixed))
    return tuple(found)


def answer_of(share: float, settings: SearchSettings = DEFAULTS) -> Fixed:
    """Whether a parameter is fixed, of which this share of the uncertainty goes."""
    reporting = settings.reporting
    return "yes" if share > reporting.fixed else "in part" if share > reporting.partly_fixed else "no"


def detectable_sizes(screen: Screen) -> tuple[DetectableSize, ...]:
    """The smallest size of each effect whose gain beyond what the hypothesis takes up is beyond chance's."""
    test = screen.settings.score_test
    beyond = max(screen.chance.gain_of(test.alpha), test.least_gain)
    best: dict[tuple[str, str], DetectableSize] = {}
    for one in screen.signatures:
        candidate, amount = one.candidate, _least_amount(screen, one, beyond)
        key = (candidate.effect, candidate.names[0])
        size = None if amount is None else candidate.scaled(one.size, amount)[0]
        if size is not None and abs(size) < candidate.least:
            size = candidate.least
        known = best[key].size if key in best else None
        if known is not None:
            size = known if size is None else candidate.weaker(known, size)
        best[key] = DetectableSize(*key, size, _unit(*key), candidate.growth == "ratio")
    return tuple(best.values())


def _least_amount(screen: Screen, one: Signature, beyond: float) -> float | None:
    """Of a signature, in units of the size it was made with, by bisection."""

    def gain(amount: float) -> float:
        z = amount * screen.flat(one.column)
        return screen.with_effect(z, one).gain - screen.own(z).gain

    low, high = np.log(screen.settings.reporting.amounts)
    if gain(float(np.exp(high))) < beyond:
        return None
    while high - low > screen.settings.reporting.amount_log_step:
        middle = (low + high) / 2
        low, high = (low, middle) if gain(float(np.exp(middle))) > beyond else (middle, high)
    return float(np.exp(high))


def _unit(effect: str, name: str) -> str:
    fields = type(getattr(Parameters(), effect)).model_fields
    extra = fields[name].json_schema_extra if name in fields else None
    return str(extra["unit"]) if isinstance(extra, dict) else "1"
