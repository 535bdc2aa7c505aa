"""Every parameter of every effect, as the effects declare them."""

import sys
from collections.abc import Iterator
from typing import Any, get_args

from pydantic.fields import FieldInfo

from voltcam_simulator import Parameters, camera_names
from voltcam_simulator.effect import About, Effect
from voltcam_simulator.effects import EFFECTS

from .markdown import name, plain, prose, table

HEAD = ("parameter", "unit", "limits", "default", "meaning", "source")
TITLES = {"light": "Light", "pixel": "Pixel", "noise": "Noise", "readout": "Readout"}


def chapter() -> str:
    """A section for each thing that effects are about; effects in the order in which light meets them."""
    parts = [
        "## Temperature\n",
        table(HEAD, [_row("temperature_c", Parameters.model_fields["temperature_c"])]),
    ]
    for about in get_args(About):
        parts.append(f"## {TITLES[about]}\n")
        parts += [_section(effect) for effect in EFFECTS if effect.about == about]
    return "\n".join(parts)


def _section(effect: type[Effect]) -> str:
    module = sys.modules[effect.__module__]
    state = "On by default." if effect().active else "Off by default."
    rows = [_row(key, field) for key, field in effect.model_fields.items()]
    return "\n\n".join(
        [
            f"### `{effect.name}`",
            prose(module.__doc__),
            prose(effect.__doc__),
            f"In the events: {plain(effect.signature)}. {state}",
            table(HEAD, rows),
        ]
    )


def _row(key: str, field: FieldInfo) -> tuple[str, ...]:
    extra = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
    choices = get_args(field.annotation)  # of the few that are no quantity
    return (
        name(key),
        plain(str(extra.get("unit", ""))),
        ", ".join(map(name, choices)) if choices else limits(field),
        name(field.default) if choices else number(field.default),
        plain(field.description or ""),
        plain(str(extra.get("source", ""))),
    )


def limits(field: FieldInfo) -> str:
    """'0 to 5', 'above 0, to 5'."""
    low = high = ""
    for one in field.metadata:
        if (ge := getattr(one, "ge", None)) is not None:
            low = number(ge)
        if (gt := getattr(one, "gt", None)) is not None:
            low = f"above {number(gt)},"
        if (le := getattr(one, "le", None)) is not None:
            high = number(le)
    return f"{low} to {high}"


def number(value: Any) -> str:
    """0.0001 as 1e-4; words as they are."""
    if isinstance(value, str):
        return value
    mantissa, e, exponent = f"{value:g}".partition("e")
    return f"{mantissa}e{int(exponent)}" if e else mantissa


def presets() -> str:
    """What each named camera says, where any of them differs from the default."""
    cameras = {camera: dict(_values(Parameters.of(camera))) for camera in camera_names()}
    defaults = dict(_values(Parameters()))
    differing = [key for key, value in defaults.items() if any(c[key] != value for c in cameras.values())]
    rows = [
        (
            name(key),
            number(defaults[key]),
            *(_differing(camera[key], defaults[key]) for camera in cameras.values()),
        )
        for key in differing
    ]
    return table(("parameter", "default", *map(name, cameras)), rows)


def _differing(value: Any, default: Any) -> str:
    return f"**{number(value)}**" if value != default else "·"


def _values(parameters: Parameters) -> Iterator[tuple[str, Any]]:
    yield "temperature_c", parameters.temperature_c
    for effect in parameters.effects():
        for key, value in effect.model_dump().items():
            yield f"{effect.name}.{key}", value
