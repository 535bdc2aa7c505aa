"""J: each interval under the exact law: how likely it was to be over by then, along the scene's own path.

From an event at t0 the voltage goes by Brownian motion along M(t) = k1 ln((L(t) + k2)/(L(t0) + k2)) + leak,
with variance S(t) = integral of sigma^2. The time at which it first meets theta is, with the drift taken as a
straight line to M(t), inverse Gaussian (s = sqrt(S)),

    P(before t) = Phi((M - theta)/s) + exp(2 M theta/S) Phi(-(M + theta)/s).

What the law leaves out shows in how these are spread, and in whether one tells of the next:

    an excess that stays with the pixel (mismatch)        successors are alike              products > 0
    one that is drawn anew at each event (reset noise)    they have nothing in common       products = 0
    an error of the time of an event (jitter)             what one gains, the next loses    products < 0

Squares and products are about the mean of each polarity, speed and brightness, which base parameters move.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_lab.statistics.group import MOTION, POLARITY, Group, Values, bin_numbers, labels, sums, tally
from voltcam_lab.statistics.setting import Setting
from voltcam_lab.statistics.strata import INTENSITIES, INTENSITY_NAMES, SLOPE_NAMES, SLOPES
from voltcam_lab.statistics.stream import EventTable
from voltcam_lab.statistics.trend import SLICES, TIME, slice_of
from voltcam_simulator.kernel import kernel

PROBABILITY_EDGES = (0.001, 0.02, 0.15, 0.5, 0.85, 0.98, 0.999)
PROBABILITY_BINS = len(PROBABILITY_EDGES) + 1
_PROBABILITY = (
    "probability",
    tuple(f"{a:g} to {b:g}" for a, b in zip((0, *PROBABILITY_EDGES), (*PROBABILITY_EDGES, 1), strict=True)),
)
_SPEED = ("speed", ("rest", "slow", "fast"))
FLOOR = 0.1  # of a threshold: parameters that are off by a third must not drive the scores to their limits
_CLIP = 4.0

_LABELS = (
    *labels("J", "intervals", "count", MOTION, POLARITY, _PROBABILITY),
    *labels("J", "excess", "value", MOTION, POLARITY, ("intensity", INTENSITY_NAMES), floor=2.0),
    *labels("J", "excess", "value", POLARITY, ("slope", SLOPE_NAMES), floor=2.0),
    *labels("J", "excess at rest", "value", POLARITY, TIME, floor=2.0),
    *labels("J", "excess squared", "value", POLARITY, _SPEED, floor=8.0),
    *labels("J", "excess times the one before", "value", POLARITY, _SPEED, floor=8.0),
)


def observe_first_passage(setting: Setting, stream: EventTable) -> Values:
    """The excess is the score (M - theta)/s; only intervals that begin with the same polarity count."""
    n = len(stream.t_us)
    same, probability, score = np.zeros(n, np.bool_), np.zeros(n), np.zeros(n)
    transform(
        stream.former, stream.on, stream.log, np.exp(stream.log), stream.interval_us, law_of(setting),
        same, probability, score,
    )  # fmt: skip
    part, kind = stream.part, 2 * stream.moving + stream.on
    bins = bin_numbers(probability, PROBABILITY_EDGES)
    speed = 3 * stream.on + np.array([2, 1, 1, 1, 2, 0])[stream.slope]
    third = stream.thirds
    cell = (same * 6 + speed) * INTENSITIES + stream.intensity
    own = about_mean(part, cell, score, 12 * INTENSITIES)
    time = np.where(stream.moving == 1, -1, stream.on * SLICES + slice_of(setting, stream))
    return np.hstack([
        tally(part, np.where(same, kind * PROBABILITY_BINS + bins, -1), 4 * PROBABILITY_BINS),
        sums(part, kind * INTENSITIES + stream.intensity, score, 4 * INTENSITIES),
        sums(part, stream.on * SLOPES + stream.slope, score, 2 * SLOPES),
        sums(part, time, score, 2 * SLICES),
        sums(part, np.where(same, speed, -1), own**2, 6),
        sums(part[third], speed[third], own[third] * own[stream.former[third]], 6),
    ])  # fmt: skip


def about_mean(
    part: NDArray[np.uint8], cell: NDArray[np.int64], score: NDArray[np.float64], cells: int
) -> NDArray[np.float64]:
    """(n,) scores minus the mean of their cell in their part."""
    mean = sums(part, cell, score, cells) / np.maximum(tally(part, cell, cells), 1)
    difference: NDArray[np.float64] = score - mean[part, cell]
    return difference


def law_of(setting: Setting) -> NDArray[np.float64]:
    """k1, k2, k3, k4, k5, k6, theta of OFF and ON, as numbers for the kernel."""
    p = setting.parameters
    return np.array([
        p.contrast_response.k1, p.contrast_response.k2_dn, p.photon_noise.k3, p.junction_leak.k4_per_us,
        p.parasitic_photocurrent.k5_per_dn_us, p.leak_noise.k6, p.comparator.theta_off, p.comparator.theta_on,
    ])  # fmt: skip


@kernel
def transform(
    former: Any, on: Any, log: Any, raised: Any, interval_us: Any, law: Any, same: Any, probability: Any,
    score: Any,
) -> None:  # fmt: skip
    """Where the event before has the same polarity, fill same, probability and score (n,).

    raised is L + k2; leak and noise go by the mean of the two ends.
    """
    k1, k2, k3, k4, k5, k6 = law[:6]
    for i in range(former.size):
        j = former[i]
        if j < 0 or on[j] != on[i]:
            continue
        same[i] = True
        light = max(0.5 * (raised[i] + raised[j]) - k2, 0.0)
        sigma = k3 * math.sqrt(light) / (light + k2) + k6
        theta = law[6 + on[i]]
        mean = k1 * (log[i] - log[j]) + (k4 + k5 * light) * interval_us[i]
        mean = mean if on[i] else -mean
        variance = sigma * sigma * interval_us[i] + (FLOOR * theta) ** 2
        s = math.sqrt(variance)
        excess = (mean - theta) / s
        score[i] = min(max(excess, -_CLIP), _CLIP)
        probability[i] = 0.5 * math.erfc(-excess / math.sqrt(2.0))
        if s > 0.15 * theta:  # else the second term is small
            late = 0.5 * math.erfc((mean + theta) / (s * math.sqrt(2.0)))
            probability[i] += math.exp(min(2 * mean * theta / variance, 700.0)) * late


FIRST_PASSAGE = Group("J", _LABELS, observe_first_passage)
