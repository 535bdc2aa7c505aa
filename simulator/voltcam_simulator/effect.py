"""What an effect is: one physical mechanism, its parameters, and what it does to light, pixels or events.

An effect is a frozen pydantic model: its fields are the parameters, each made by `quantity` with unit,
limits, meaning and source, and everything that names parameters (config file, command line, REST,
sliders, docs) reads them from here. It acts by overriding one or more of the stages below; the simulator
calls, in registry order, only those that an active effect overrides.

    prepare   once for each set of parameters: the fixed pattern of the sensor
    see       the light on the pixels at one instant
    respond   the voltage that the light gives at that instant
    drift     what drift and noise add over the step between two instants
    report    the events of an interval, on their way from the pixels to the user
"""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, field_validator

from .groups import Bend, Place
from .limits import Limits
from .random import events_generator, events_key, pattern

EVENT = np.dtype([("t", "<i8"), ("x", "<u2"), ("y", "<u2"), ("p", "?")])
"""One event: t [us], x, y [pixels], p (True = ON). The same as the client's."""


STRAIGHT = Bend(None, None)
ROOM = 6.0  # standard deviations of a Poisson number: more come once in 10^9 times
Plane = NDArray[np.float32]
Image = NDArray[np.uint8] | Plane
Events = NDArray[np.void]
State = dict[str, NDArray[Any]]
About = Literal["light", "pixel", "noise", "readout"]


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
    temperature_c: float
    dark_level_dn: float  # k2, which Eq. 10 and Eq. 11 share
    theta_on: Plane
    theta_off: Plane
    leak: Plane | None = None  # factor on the leak of each pixel; None: 1 everywhere
    refractory_us: float = 0.0
    reset_sigma: float = 0.0
    own: dict[str, State] = field(default_factory=dict)
    """Patterns that only one effect reads, by its name."""
    set_us: dict[str, float] = field(default_factory=dict)
    """When each effect was set to what it is, by its name, from the first frame."""

    def pattern(self, name: str) -> np.random.Generator:
        """Random numbers for one effect's pattern: repeatable, and not moved by other effects."""
        return pattern(self.seed, name)


@dataclass
class Band:
    """Some rows of pixels over one step in time: what an effect sees, and changes.

    Planes are (pixels,) float32. `see` and `respond` are about the end of the step; when an image is shown as
    if it had been there for long, `span_us` is 0. Noise terms share one Wiener process, so their standard
    deviations add in `noise` (Eq. 11); independent ones add in `noise2`.
    """

    sensor: Sensor
    first_row: int
    start_us: int
    span_us: float
    elapsed_us: float  # from the first frame to the start of the step
    temperature_c: float
    light_before: Plane  # grey level at the start [DN]
    light: Plane  # and at the end
    response: Plane  # voltage that belongs to the light at the end [nominal thresholds]
    drift: Plane  # voltage gained over the step beside the response [nominal thresholds]
    noise: Plane  # sigma [1/sqrt(us)]
    bow: Plane  # how far the voltage leaves a straight line over the step, see `bend` [nominal thresholds]
    rate: Plane  # and how fast it comes back to it [time constants a step]
    is_bent: bool = False  # whether bow and rate count
    noise2: Plane | None = None  # sigma^2 of independent noise [1/us]
    leak: Plane | None = None  # this band's part of the sensor's
    kicks: list[tuple[NDArray[np.float64], float]] = field(default_factory=list)
    """Sudden changes of voltage: (time for each row of the band [us into the step], size [thresholds]).
    A row whose time is not in (0, span_us] has it in another step."""
    planes: dict[str, State] = field(default_factory=dict)
    """State of each effect that has some: this band's part, kept from step to step."""

    @property
    def end_us(self) -> float:
        """The instant of `light` and `response`."""
        return self.start_us + self.span_us

    @property
    def bend(self) -> Bend:
        """How the response goes between the instants: straight, unless an effect has filled bow and rate."""
        return Bend(self.bow, self.rate) if self.is_bent else STRAIGHT

    @property
    def place(self) -> Place:
        """Where its pixels are."""
        width = self.sensor.width
        return Place(self.first_row, 0, self.light.size // width, width)

    def apply(self, kernel: Callable[..., None], *arguments: Any) -> None:
        """Run a kernel over planes of this band: kernel(*arguments).

        Effects change planes by this alone, one pixel from its own values: so on a GPU, where a thread has
        one pixel, the same kernels run, given its planes of one pixel.
        """
        kernel(*arguments)

    def copied(self, plane: Plane) -> Plane:
        """A copy that lasts for the step."""
        return plane.copy()

    def independent_noise(self) -> Plane:
        """`noise2`, made when the first effect needs it."""
        if self.noise2 is None:
            self.noise2 = np.zeros_like(self.noise)
        return self.noise2


@dataclass
class EventInterval:
    """An interval as the event stages see it: earlier, behind one that stamps events earlier."""

    sensor: Sensor
    start_us: int
    end_us: int
    interval: int
    state: dict[str, State]
    voltage: (
        Plane  # (pixels,) voltages at the end of the interval; for an effect that `feeds_back`, to change
    )
    light: Plane  # (pixels,) what the pixels see then [DN]; for one that `sees_light`
    limits: Limits

    @property
    def span_us(self) -> int:
        """Length of the interval."""
        return self.end_us - self.start_us

    def admit(self, count: float) -> None:
        """Called before space is taken for so many events of an effect's own. Raises GivenUpError."""
        self.limits.admit(count)
        self.limits.hurry()

    def filled(self, expected: float, fill: Callable[[Events], int]) -> Events:
        """An effect's own events, about so many: fill(events) writes as many as there is room for, and
        returns how many there are; it is called again where there was not enough. Raises GivenUpError."""
        self.admit(expected)
        events = np.empty(int(expected + ROOM * math.sqrt(expected)) + 2, EVENT)
        count = fill(events)
        if count > len(events):
            self.admit(count)
            events = np.empty(count, EVENT)
            fill(events)
        return events[:count]

    def generator(self, name: str) -> np.random.Generator:
        """Random numbers for one effect in this interval."""
        return events_generator(self.sensor.seed, name, self.interval)

    def key(self, name: str) -> np.uint64:
        """The same for kernels: where the sequence of its numbers starts."""
        return events_key(self.sensor.seed, name, self.interval)


def no_truth(value: Any) -> Any:
    """YAML and JSON have true and false, which would pass for 1 and 0."""
    if isinstance(value, bool):
        raise ValueError("give a number")
    return value


def _describe_effect(schema: dict[str, Any], effect: type["Effect"]) -> None:
    """For the page: what it is about, and whether its defaults leave it off."""
    schema["about"] = effect.about
    schema["off_by_default"] = not effect().active


class Effect(BaseModel):
    """Base of all effects; `name` is the class name in snake case, the key in files, REST and diagnosis."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, json_schema_extra=_describe_effect
    )

    _numbers = field_validator("*", mode="before")(no_truth)

    name: ClassVar[str]
    about: ClassVar[About]
    """What people look for it under."""

    signature: ClassVar[str]
    """How it shows in the events: the line a person looks for in a recording."""

    steady: ClassVar[bool] = False
    """True for one that adds the same in each microsecond while the frames stand still, whatever was before,
    and leaves voltages alone: when all that are on are steady, rows that stand still are drawn ahead."""

    instant: ClassVar[bool] = False
    """True for one that gives each pixel the same at any time: from its light, that before, its leak and its
    place alone. When all that act on pixels are instant, several steps are seen in one call."""

    feeds_back: ClassVar[bool] = False
    """True for one whose `report` changes the pixels' voltages."""

    sees_light: ClassVar[bool] = False
    """True for one whose `report` looks at the light of the pixels."""

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        super().__pydantic_init_subclass__(**kwargs)
        cls.name = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", cls.__name__).lower()

    @property
    def active(self) -> bool:
        """False when the parameters make it do nothing; it is then not called."""
        return True

    @property
    def longest_step_us(self) -> float:
        """The longest step over which it may be taken as a straight line; inf: any."""
        return np.inf

    @property
    def earliest_us(self) -> int:
        """How much earlier than an interval it may stamp its events: they wait as long, if it is above 0."""
        return 0

    def stamp_us(self, t_us: int) -> int:
        """The earliest stamp that it gives what reaches it at t_us or later."""
        return t_us

    def state(self, sensor: Sensor) -> State:
        """Arrays it keeps between calls; float32 ones of (..., height * width) are handed out by band."""
        return {}

    def prepare(self, sensor: Sensor) -> None:
        """Lay down the fixed pattern. Called once for each set of parameters; must be repeatable."""

    def see(self, band: Band) -> None:
        """Change `band.light`."""

    def respond(self, band: Band) -> None:
        """Add to or change `band.response`."""

    def drift(self, band: Band) -> None:
        """Add to the drift, noise and kicks of a band."""

    def report(self, events: Events, readout: EventInterval) -> Events:
        """The events as they go on: some more, some less, some later.

        events: all that reach this stage in the interval, sorted by time; may be changed in place. Returns
        them sorted by time. Those later than the end of the interval reach the next stage in the interval
        in which they are due.
        """
        return events


def overrides(effect: Effect, stage: str) -> bool:
    """True when this effect does something in a stage."""
    return getattr(type(effect), stage) is not getattr(Effect, stage)
