"""Cameras at random: each parameter fixed, or drawn from a range, a few values, or a calibration's interval.

cameras = CameraDistribution.of("davis346", {"comparator": {"theta_on": {"uniform": [0.8, 1.2]}}})
camera = cameras.draw(np.random.default_rng(1))
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from annotated_types import Ge, Gt, Le
from pydantic import ValidationError

from voltcam_simulator import Camera, Parameters
from voltcam_simulator.camera_file import intervals_of, read

Kind = Literal["fixed", "uniform", "log_uniform", "choice"]
INTERVAL = "interval"
WAYS = "give a value, {uniform: [LOW, HIGH]}, {log_uniform: [LOW, HIGH]}, {choice: [A, B]} or interval"


@dataclass(frozen=True)
class Distribution:
    """Of one parameter. values: the one, low and high, or those to choose from. whole: whole numbers only."""

    kind: Kind
    values: tuple[Any, ...]
    whole: bool = False

    def draw(self, generator: np.random.Generator) -> Any:
        """One value; `fixed` takes no random number."""
        if self.kind == "fixed":
            return self.values[0]
        if self.kind == "choice":
            return self.values[int(generator.integers(len(self.values)))]
        low, high = self.values
        if self.kind == "uniform" and self.whole:
            return int(generator.integers(low, high + 1))
        if self.kind == "uniform":
            return float(generator.uniform(low, high))
        drawn = math.exp(generator.uniform(math.log(low), math.log(high)))
        within = min(max(drawn, low), high)  # rounding of exp must not leave what was checked
        return round(within) if self.whole else within


@dataclass(frozen=True)
class CameraDistribution:
    """Cameras, each as likely as the others, with what is drawn of each one's parameters ("effect.name")."""

    cameras: tuple[Camera, ...]
    drawn: tuple[Mapping[str, Distribution], ...]

    @classmethod
    def of(
        cls,
        cameras: str | Path | Sequence[str | Path],
        parameters: Mapping[str, Any] | None = None,
        *,
        intervals: bool = False,
    ) -> "CameraDistribution":
        """cameras: names or camera files, of which one is drawn. parameters: nested by effect, each a value,
        {"uniform": [low, high]}, {"log_uniform": [low, high]}, {"choice": [...]} or "interval": from the
        interval that the camera file has. intervals: so for every parameter of which it has one.

        Raises ValueError, a line that names the parameter, for what is unknown or out of its limits, and as
        `Camera.load`.
        """
        names = [cameras] if isinstance(cameras, str | Path) else list(cameras)
        if not names:
            raise ValueError("camera: none is given: name one, or a camera file")
        loaded = tuple(Camera.load(name) for name in names)
        asked = dict(_flat(parameters or {}))
        drawn = []
        for name, camera in zip(names, loaded, strict=True):
            known = _calibrated(name)
            own = dict(known) if intervals else {}
            if intervals and not known:
                raise ValueError(
                    f"{name} has no intervals: `voltcam calibrate` writes a camera file that has"
                )
            for parameter, how in asked.items():
                if how == INTERVAL and parameter not in known:
                    raise ValueError(f"parameters.{parameter}: {name} has no interval of it: give a range")
                own[parameter] = known[parameter] if how == INTERVAL else _distribution(parameter, how)
            for parameter, distribution in own.items():
                _check(camera, parameter, distribution)
            drawn.append(own)
        return cls(loaded, tuple(drawn))

    def draw(self, generator: np.random.Generator) -> Camera:
        """A camera; the same state of the generator gives the same, in whatever order a spec names them."""
        which = int(generator.integers(len(self.cameras)))
        camera, drawn = self.cameras[which], self.drawn[which]
        changes: dict[str, Any] = {}
        for name in sorted(drawn):
            _put(changes, name, drawn[name].draw(generator))
        return camera.model_copy(update={"parameters": camera.parameters.changed(changes)})

    @property
    def varied(self) -> tuple[str, ...]:
        """The parameters that are not the same in all cameras drawn from one file."""
        return tuple(
            sorted({name for each in self.drawn for name, how in each.items() if how.kind != "fixed"})
        )


def _flat(parameters: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """("effect.name", how) of each; raises ValueError for what is no parameter."""
    for effect, content in parameters.items():
        field = Parameters.model_fields.get(effect)
        if field is None:
            raise ValueError(f"parameters.{effect}: there is no such effect: `voltcam schema` lists them")
        if not hasattr(field.annotation, "model_fields"):
            yield effect, content
            continue
        own: Mapping[str, Any] = field.annotation.model_fields  # type: ignore[union-attr]
        if not isinstance(content, Mapping):
            raise ValueError(f"parameters.{effect}: it has several parts, {', '.join(own)}: name one")
        for name, how in content.items():
            if name not in own:
                raise ValueError(
                    f"parameters.{effect}.{name}: there is no such parameter, only {', '.join(own)}"
                )
            yield f"{effect}.{name}", how


def _distribution(name: str, how: Any) -> Distribution:
    if not isinstance(how, Mapping):
        return Distribution("fixed", (how,))
    if len(how) != 1 or (kind := next(iter(how))) not in ("uniform", "log_uniform", "choice"):
        raise ValueError(f"parameters.{name}: {dict(how)} is no distribution: {WAYS}")
    values = how[kind]
    if not isinstance(values, Sequence) or isinstance(values, str) or not values:
        raise ValueError(f"parameters.{name}: {kind} takes a list, not {values!r}: {WAYS}")
    if kind == "choice":
        return Distribution("choice", tuple(values))
    return _range(name, kind, values)


def _range(name: str, kind: Kind, values: Sequence[Any]) -> Distribution:
    try:
        low, high = (float(value) for value in values)
    except (TypeError, ValueError):
        raise ValueError(f"parameters.{name}: {kind} takes two numbers, not {list(values)}") from None
    if not (math.isfinite(low) and math.isfinite(high) and low <= high):
        raise ValueError(f"parameters.{name}: {kind} takes a low and a high end, not {low:g} and {high:g}")
    if kind == "log_uniform" and low <= 0:
        raise ValueError(f"parameters.{name}: log_uniform begins above 0, not at {low:g}: give uniform")
    whole = _field(name).annotation is int
    return Distribution(kind, (round(low), round(high)) if whole else (low, high), whole)


def _calibrated(camera: str | Path) -> dict[str, Distribution]:
    """Of a camera file's intervals: log-uniform above 0, since such parameters are known to a factor. What a
    parameter cannot be is left out of its interval."""
    known = {}
    for name, (low, high) in intervals_of(read(camera)).items():
        least, most = _limits(name)
        low, high = max(low, least), min(high, most)
        known[name] = _range(name, "log_uniform" if low > 0 else "uniform", (low, high))
    return known


def _check(camera: Camera, name: str, distribution: Distribution) -> None:
    """Each end and each choice by itself; raises ValueError."""
    for value in distribution.values:
        changes: dict[str, Any] = {}
        _put(changes, name, value)
        try:
            camera.parameters.changed(changes)
        except ValidationError as error:
            raise ValueError(f"parameters.{name}: {error.errors()[0]['msg']}, not {value!r}") from None


def _field(name: str) -> Any:
    effect, _, own = name.partition(".")
    field: Any = Parameters.model_fields[effect]
    return field.annotation.model_fields[own] if own else field


def _limits(name: str) -> tuple[float, float]:
    """Least and largest value. Raises ValueError for an unknown name."""
    try:
        rules = _field(name).metadata
    except (KeyError, AttributeError):
        raise ValueError(f"intervals.{name}: there is no such parameter") from None
    limits: dict[str, Any] = {}
    for rule in rules:
        if isinstance(rule, Ge | Gt | Le):
            limits |= asdict(rule)
    return float(limits.get("ge", limits.get("gt", -math.inf))), float(limits.get("le", math.inf))


def _put(changes: dict[str, Any], name: str, value: Any) -> None:
    effect, _, own = name.partition(".")
    if own:
        changes.setdefault(effect, {})[own] = value
    else:
        changes[effect] = value
