"""The function that a thread runs for the effects of its pixel, written from the notes of a `TracedBand`."""

import functools
from collections.abc import Callable
from typing import Any

from .target import on_device
from .traced_band import TracedBand

Calls = tuple[tuple[Callable[..., None], tuple[str, ...]], ...]


def calls_of(band: TracedBand) -> Calls:
    """What a function is written from: the same for the same effects, whatever their numbers."""
    return tuple(band.calls)


def source(calls: Calls) -> str:
    """Its text: band, a `PixelBand`; place, a `Place`; planes, tables and numbers, tuples; i, the pixel."""
    lines = [f"    kernel_{k}({', '.join(given)})" for k, (_, given) in enumerate(calls)]
    return "\n".join(["def effects(band, place, planes, tables, numbers, i):", *(lines or ["    pass"]), ""])


@functools.lru_cache(maxsize=64)
def effects_of(calls: Calls) -> Any:
    """The function for the device."""
    scope: dict[str, Any] = {f"kernel_{k}": kernel for k, (kernel, _) in enumerate(calls)}
    exec(compile(source(calls), "<effects of a pixel>", "exec"), scope)
    return on_device(scope["effects"])
