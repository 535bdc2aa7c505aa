"""The bias currents of a DAVIS, by the names its drivers have, and what they do to the parameters.

A bias is a current, fine/256 of one of eight coarse currents, each eight times the one below (Delbruck,
Berner, Lichtsteiner, Dualibe: 32-bit configurable bias current generator, ISCAS 2010). What it does follows
from the ratio to its usual current, so a camera at the usual biases is as its parameters say:

- `ONBn`, `OFFBn` and `DiffBn`: thresholds go as ln(I_on/I_diff) and ln(I_diff/I_off) (Nozaki and Delbruck
  2017, Eq. 7; Lichtsteiner, Posch, Delbruck 2008).
- `RefrBp`: the dead time goes as 1/I, the current recharges a capacitor (Lichtsteiner et al. 2008).
- `PrBp` and `PrSFBp`: photoreceptor and source follower are as fast as their currents are large, as below
  threshold transconductance is; jAER's control of the bandwidth scales both.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from pydantic import BaseModel, ConfigDict, Field, create_model, field_validator

from .parameters import Parameters

COARSE_STEP = 8.0
SMALLEST_FINE = 0.5
"""What fine 0 is taken for: a mirror that is off leaks. Ours; with it usual OFFBn and ONBn of the drivers
give thresholds of like size, ln(78) and ln(328)."""
FOLLOWER_HZ = 3000.0
"""The source follower's speed at the usual PrSFBp, where the camera says no limit: kHz, see the registry."""


class Bias(NamedTuple):
    """A bias as it is set: coarse 0 to 7, fine 0 to 255."""

    coarse: int
    fine: int

    @property
    def current(self) -> float:
        """In coarse currents of the lowest step."""
        return COARSE_STEP**self.coarse * max(self.fine, SMALLEST_FINE) / 256


USUAL = {
    "DiffBn": Bias(4, 39),
    "ONBn": Bias(6, 200),
    "OFFBn": Bias(4, 0),
    "PrBp": Bias(2, 58),
    "PrSFBp": Bias(1, 33),
    "RefrBp": Bias(4, 25),
}
"""What drivers set at the start (DAVIS240C and DAVIS346: parameters of the ROS drivers and cAER)."""
MEANING = {
    "DiffBn": "what both thresholds are measured from: more brings ON nearer, and OFF farther",
    "ONBn": "ON threshold: more is less sensitive",
    "OFFBn": "OFF threshold: less is less sensitive",
    "PrBp": "speed of the photoreceptor",
    "PrSFBp": "speed of the source follower behind it",
    "RefrBp": "dead time: more is shorter",
}


class BiasSet(BaseModel):
    """What is common to any set of biases; use `Biases`, which has both numbers of each."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @field_validator("*", mode="before")
    @classmethod
    def _whole(cls, value: Any) -> Any:
        """JSON has one kind of number: 3.0 is 3."""
        return int(value) if isinstance(value, float) and value.is_integer() else value

    def of(self, name: str) -> Bias:
        """One of them, by its name in USUAL."""
        return Bias(getattr(self, f"{name}_coarse"), getattr(self, f"{name}_fine"))

    def ratio(self, name: str) -> float:
        """Its current over the usual one."""
        return self.of(name).current / USUAL[name].current


def _fields() -> dict[str, Any]:
    fields: dict[str, Any] = {}
    for name, usual in USUAL.items():
        for part, most in (("coarse", 7), ("fine", 255)):
            meaning = f"{MEANING[name]}; {part} part"
            default: int = getattr(usual, part)
            fields[f"{name}_{part}"] = (int, Field(default, ge=0, le=most, strict=True, description=meaning))
    return fields


Biases: type[BiasSet] = create_model(
    "Biases", __base__=BiasSet, __doc__="The biases of a DAVIS, named as its drivers name them.", **_fields()
)


def changes_for(biases: BiasSet, camera: Parameters) -> dict[str, Any]:
    """What biases make of the parameters that a camera has at the usual ones, for `Parameters.changed`.

    An effect that the camera is without stays off. Values keep to the registry's limits: where ONBn is not
    above DiffBn, or OFFBn not below, the pixels of a DAVIS fire without end, and here at the least threshold.
    """
    diff = biases.of("DiffBn").current
    on, off = (math.log(biases.of(name).current / diff) for name in ("ONBn", "OFFBn"))
    follower_hz = camera.photoreceptor_bandwidth.follower_hz
    if follower_hz == 0 and biases.of("PrSFBp") != USUAL["PrSFBp"]:
        follower_hz = FOLLOWER_HZ
    wanted = {
        "comparator": {
            "theta_on": camera.comparator.theta_on * (on / _usual_log("ONBn")),
            "theta_off": camera.comparator.theta_off * (off / _usual_log("OFFBn")),
        },
        "refractory_period": {"period_us": camera.refractory_period.period_us / biases.ratio("RefrBp")},
        "photoreceptor_bandwidth": {
            "cutoff_hz": camera.photoreceptor_bandwidth.cutoff_hz * biases.ratio("PrBp"),
            "follower_hz": follower_hz * biases.ratio("PrSFBp"),
        },
    }
    return {
        effect: {name: _within_limits(getattr(camera, effect), name, value) for name, value in values.items()}
        for effect, values in wanted.items()
    }


def biases_of(now: Parameters, camera: Parameters, last: BiasSet) -> BiasSet:
    """The biases of a camera with parameters `now`, which has those of `camera` at the usual biases.

    Those that were set last stay as they were set where they give the parameters of now, or where the camera
    is without what they scale; others are the nearest to what gives them.
    """
    diff = last.of("DiffBn").current
    low_pass = "photoreceptor_bandwidth"
    on = _ratio(now, camera, "comparator", "theta_on")
    off = _ratio(now, camera, "comparator", "theta_off")
    dead = _ratio(now, camera, "refractory_period", "period_us")
    fast = _ratio(now, camera, low_pass, "cutoff_hz")
    follow = _ratio(now, camera, low_pass, "follower_hz", FOLLOWER_HZ)
    currents = {
        "ONBn": diff * math.exp((on or 1) * _usual_log("ONBn")),
        "OFFBn": diff * math.exp((off or 1) * _usual_log("OFFBn")),
        "RefrBp": USUAL["RefrBp"].current / dead if dead else None,
        "PrBp": USUAL["PrBp"].current * fast if fast else None,
        "PrSFBp": USUAL["PrSFBp"].current * follow if follow else None,
    }
    found = {name: _nearest(current, last.of(name)) for name, current in currents.items()}
    found["DiffBn"] = last.of("DiffBn")
    return Biases(**{f"{name}_{part}": getattr(found[name], part) for name in USUAL for part in Bias._fields})


def with_changes(biases: BiasSet, changes: Mapping[str, Any]) -> BiasSet:
    """Some of them changed. Raises pydantic.ValidationError."""
    return Biases.model_validate(biases.model_dump() | dict(changes))


def _within_limits(effect: BaseModel, name: str, value: float) -> float:
    limits = type(effect).model_json_schema()["properties"][name]
    return float(min(max(value, limits.get("minimum", -math.inf)), limits.get("maximum", math.inf)))


def _usual_log(name: str) -> float:
    return math.log(USUAL[name].current / USUAL["DiffBn"].current)


def _ratio(now: Parameters, camera: Parameters, effect: str, name: str, otherwise: float = 0.0) -> float:
    """A parameter over the camera's, which is `otherwise` where it is 0; 0 where there is no ratio."""
    value: float = getattr(getattr(now, effect), name)
    usual: float = getattr(getattr(camera, effect), name) or otherwise
    return float(value / usual) if value > 0 and usual > 0 else 0.0


def _nearest(current: float | None, last: Bias) -> Bias:
    """The bias nearest to a current; the last one if that gives it, or if nothing is known of it."""
    if current is None or math.isclose(last.current, current, rel_tol=1e-5):
        return last
    found = [
        Bias(coarse, min(max(round(current / COARSE_STEP**coarse * 256), 1), 255)) for coarse in range(8)
    ]
    return min(
        found, key=lambda bias: (abs(math.log(bias.current / current)), abs(bias.coarse - last.coarse))
    )
