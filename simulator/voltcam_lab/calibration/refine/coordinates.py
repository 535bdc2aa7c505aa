"""The coordinates in which a camera is searched for: what can be moved without moving all the rest."""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters

from ...light.grey import WHITE_DN
from ...models.exact import K1_TO_K6, SPREADS

LEAST_KNEE_DN = 1e-3  # above the pedestal: where it is less, there is no such camera
FASTEST_HZ = 1e5  # of a photoreceptor that has a follower and no other limit
DARKEST_TOLD_DN = 4.0  # grey levels below that are near a camera's black, where they tell least of the light

Point = Mapping[str, float]
"""Coordinates of the search; positive, except that what may be absent is 0 then.

gain: events for a change of ln (grey level) where it is bright, k1 times gamma. knee_dn: grey level that
stands for a light of k2, plus pedestal_dn. So curvature (gamma), dark level, gain and what black stands for
can each be moved without the others."""

CORE = ("gain", "on_over_off", "knee_dn", "period_us")
OFFERED: tuple[tuple[str, tuple[float, ...]], ...] = (
    ("threshold_spread", (0.05, 0.12)),
    ("reset_spread", (0.03, 0.08)),
    ("coupling", (0.001, 0.003, 0.008)),
    ("follower_hz", (300.0, 100.0, 30.0)),
    ("cutoff_hz", (1500.0, 500.0, 200.0)),
    ("k4_per_us", (1e-8, 1e-7)),
    ("k5_per_dn_us", (1e-10, 1e-9)),
    ("leak_spread", (0.3,)),
    ("k3", (3e-4, 1e-3)),
    ("k6", (3e-5, 1e-4)),
    ("shot_c", (3e-3, 1e-2)),
    ("pairs_hz", (0.03, 0.3)),
    ("hot", (3e-4, 3e-3)),
)
"""Mechanisms that may be there or not, the likely ones first, and sizes to try them at."""

BENT = ("gain", "knee_dn", "on_over_off")
FRAMES = {"gamma": 1.0, "pedestal_dn": 0.0, "highlight": 1.0, "slack_dn": 0.0}
ABSENT = FRAMES | {name: 0.0 for name, _ in OFFERED}
PLACES = (
    SPREADS
    | {name: K1_TO_K6[name] for name in ("k3", "k4_per_us", "k5_per_dn_us", "k6")}
    | {
        "delay_us": ("latency", "delay_us"),
        "period_us": ("refractory_period", "period_us"),
        "gamma": ("input_response", "gamma_exponent"),
        "pedestal_dn": ("input_response", "pedestal_dn"),
        "highlight": ("input_response", "highlight"),
        "slack_dn": ("frame_noise", "slack_dn"),
        "coupling": ("crosstalk", "coupling"),
        "cutoff_hz": ("photoreceptor_bandwidth", "cutoff_hz"),
        "follower_hz": ("photoreceptor_bandwidth", "follower_hz"),
        "shot_c": ("low_light_shot_noise", "c"),
        "pairs_hz": ("noise_pairs", "rate_hz"),
        "hot": ("hot_pixels", "fraction"),
    }
)


def point_of(parameters: Parameters) -> dict[str, float]:
    """Coordinates of a camera."""
    comparator, response = parameters.comparator, parameters.contrast_response
    point = {name: float(getattr(getattr(parameters, at), key)) for name, (at, key) in PLACES.items()}
    unit = math.sqrt(comparator.theta_on * comparator.theta_off)
    for name in ("reset_spread", "coupling", "k3", "k4_per_us", "k5_per_dn_us", "k6", "shot_c"):
        point[name] /= unit
    gamma = point["gamma"]
    return point | {
        "gain": response.k1 * gamma / unit,
        "on_over_off": comparator.theta_on / comparator.theta_off,
        "knee_dn": WHITE_DN * (response.k2_dn / WHITE_DN) ** (1 / gamma) + point["pedestal_dn"],
    }


def parameters_at(point: Point, base: Parameters) -> Parameters:
    """The camera at these coordinates; the rest as in `base`. Raises pydantic's ValidationError, which is a
    ValueError, where they are outside of what parameters may be."""
    changes: dict[str, dict[str, float]] = {}
    for name, (effect, parameter) in PLACES.items():
        changes.setdefault(effect, {})[parameter] = point[name]
    if point["follower_hz"] > 0 and point["cutoff_hz"] == 0:
        changes["photoreceptor_bandwidth"]["cutoff_hz"] = FASTEST_HZ
    gamma, ratio = point["gamma"], math.sqrt(point["on_over_off"])
    changes["contrast_response"] = {
        "k1": point["gain"] / gamma,
        "k2_dn": WHITE_DN * (max(point["knee_dn"] - point["pedestal_dn"], 0.0) / WHITE_DN) ** gamma,
    }
    changes["comparator"] = {"theta_on": ratio, "theta_off": 1 / ratio}
    sooner_us = base.latency.delay_us - point["delay_us"]  # what frames do is seen when it was
    changes["aps_coupling"] = {"offset_us": base.aps_coupling.offset_us + sooner_us}
    return base.changed(changes)


def present(point: Point) -> tuple[str, ...]:
    """Mechanisms that are there."""
    return tuple(name for name, absent in ABSENT.items() if point[name] != absent)


def response(point: Point, grey_dn: NDArray[np.float64]) -> NDArray[np.float64]:
    """Voltage of grey levels, from that of the first one on."""
    gamma, pedestal_dn = point["gamma"], point["pedestal_dn"]
    knee_dn = max(point["knee_dn"] - pedestal_dn, LEAST_KNEE_DN)
    light = np.log((grey_dn + pedestal_dn) ** gamma + knee_dn**gamma)
    return np.asarray(point["gain"] / gamma * (light - light[0]))


def with_curvature(point: Point, gamma: float, knee_dn: float) -> dict[str, float]:
    """Another gamma and knee, and the gain with which the response from dark to bright is what it was."""
    ends = np.array([DARKEST_TOLD_DN, WHITE_DN / 2])
    other = {**point, "gamma": gamma, "knee_dn": knee_dn}
    other["gain"] *= float(response(point, ends)[1] / response(other, ends)[1])
    return other
