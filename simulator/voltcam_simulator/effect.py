"""What an effect is: one physical mechanism, its parameters, and what it does to the pixels.

An effect is a frozen pydantic model: its fields are the parameters, each made by `quantity` with unit,
limits, meaning and source, and everything that names parameters (config file, command line, REST,
sliders, docs) reads them from here. It acts by overriding `prepare`, `apply` or both.
"""

import re
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from .random import pattern

EVENT = np.dtype([("t", "<i8"), ("x", "<u2"), ("y", "<u2"), ("p", "?")])
"""One event: t [us], x, y [pixels], p (True = ON). The same as the client's."""

Plane = NDArray[np.float32]


def quantity(
    default: float,
    *,
    unit: str,
    meaning: str,
    source: str,
    ge: float | None = None,
    gt: float | None = None,
    le: float,
) -> Any:
    """A parameter: default, unit ("1" for a pure number), limits, one line of meaning, where it is from."""
    return Field(
        default, ge=ge, gt=gt, le=le, description=meaning, json_schema_extra={"unit": unit, "source": source}
    )


@dataclass
class Sensor:
    """The fixed pattern of a camera: what differs from pixel to pixel. Planes are (height, width)."""

    width: int
    height: int
    seed: int
    theta_on: Plane
    theta_off: Plane

    def pattern(self, name: str) -> np.random.Generator:
        """Random numbers for one effect's pattern: repeatable, and not moved by other effects."""
        return pattern(self.seed, name)


@dataclass
class Interval:
    """A band of pixels over the time between two frames: what an effect sees, and adds to.

    Planes are (pixels,) float32. Noise terms share one Wiener process, so their standard deviations add
    (Eq. 11 of the paper).
    """

    span_us: float
    temperature_c: float
    dark_level_dn: float  # k2, which Eq. 10 and Eq. 11 share
    first: Plane  # grey level at the start [DN]
    last: Plane  # grey level at the end [DN]
    drift: Plane  # voltage gained over the interval [nominal thresholds]
    noise: Plane  # sigma [1/sqrt(us)]


class Effect(BaseModel):
    """Base of all effects; `name` is the class name in snake case, the key in files, REST and diagnosis."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    name: ClassVar[str]
    signature: ClassVar[str]
    """How it shows in the events: the line a person looks for in a recording."""

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        super().__pydantic_init_subclass__(**kwargs)
        cls.name = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", cls.__name__).lower()

    @property
    def active(self) -> bool:
        """False when the parameters make it do nothing; it is then not called."""
        return True

    def prepare(self, sensor: Sensor) -> None:
        """Lay down the fixed pattern. Called once for each set of parameters; must be repeatable."""

    def apply(self, interval: Interval) -> None:
        """Add to the drift and noise of an interval."""
