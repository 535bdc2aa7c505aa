"""What several effects do to planes: one line each, for a processor and a GPU alike."""

import math
from typing import Any

from .kernel import kernel


@kernel
def copy(source: Any, plane: Any) -> None:
    """plane = source; (n,) float32, as all here."""
    for i in range(plane.shape[0]):
        plane[i] = source[i]


@kernel
def add(plane: Any, number: Any) -> None:
    """plane += number, float32."""
    for i in range(plane.shape[0]):
        plane[i] += number


@kernel
def scale(plane: Any, factor: Any) -> None:
    """plane *= factor, float32."""
    for i in range(plane.shape[0]):
        plane[i] *= factor


@kernel
def add_product(plane: Any, number: Any, factor: Any) -> None:
    """plane += number factor, number float32, factor (n,)."""
    for i in range(plane.shape[0]):
        plane[i] += number * factor[i]


@kernel
def add_independent(noise: Any, noise2: Any) -> None:
    """noise, a standard deviation, becomes that with the variance noise2 added."""
    for i in range(noise.shape[0]):
        noise[i] = math.sqrt(noise[i] * noise[i] + noise2[i])
