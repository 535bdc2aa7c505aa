"""Calibration as DVS-Voltmeter has it (Lin et al., ECCV 2022, Section 5), beside `voltcam calibrate`.

Same-pixel intervals between events are binned by mean brightness and by its change, taken as one constant
slope for each interval. In each bin and polarity the interval follows the inverse Gaussian law (Eq. 13),
Levy's where there is no drift (Eq. 14), whose maximum likelihood gives |mu|/theta and sigma/theta. A
regression over the bins (Eq. 10, 11) then gives k1..k6. What the paper leaves open is decided here: the bins,
their weights, that sqrt(theta_on theta_off) = 1 fixes the scale, and that only quiet bins tell of sigma (the
paper sets k3 and k6 by hand: the spread of slopes within a bin would pass for noise).

What is biased, by the method itself:
- sigma is too high where the pixels of a quiet bin leak at different rates (their own mismatch, k5 within a
  bin wide in brightness, noisy frames), and where any other noise passes for it;
- a pixel that fires once is not seen, one that fires in a burst often: sigma is not taken over where it would
  give more events than quiet pixels have;
- k1 is too low where frames tell the slope badly: a bin then mixes slopes, and those below count most;
- long intervals that the recording's end cuts off are missing, so leak (k4, k5) is too high in short
  recordings, and rare noise events count as if they were regular;
- dead time, latency and thresholds that differ between pixels are no part of the law and go into the k's.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, nnls

from voltcam_simulator import Parameters

from ..light.scene import Scene
from ..light.still import still_intervals
from ..windows import Mask, Windows
from .intervals import intervals

BIN = np.dtype([
    ("brightness", "<f8"),  # mean over the bin's intervals [DN]
    ("slope", "<f8"),  # the same [DN/us]
    ("on", "?"),  # the polarity of the event that ends them
    ("quiet", "?"),  # brightness stood still
    ("n", "<i8"),
    ("mu", "<f8"),  # |mu|/theta [1/us]; 0: Levy's law
    ("sigma", "<f8"),  # sigma/theta [1/sqrt(us)]
])  # fmt: skip

Table = NDArray[np.void]
Vector = NDArray[np.float64]

SHORTEST_US = 100.0  # shorter ones are bursts of the readout, which 1/T would give all the weight
BRIGHTNESS_BINS, PER_BIN, PER_QUIET_BIN, FEWEST = 8, 200, 50, 30
MISFIT = 0.03  # of mu and sigma, relative: what the model leaves over even in a bin without noise


@dataclass(frozen=True, eq=False)
class PaperFit:
    """parameters: for law paper. bins: dtype BIN. interval_us (n,): all intervals used, bin_of (n,) the row
    of bins that each is in. notes: what was not determined, a line each."""

    parameters: Parameters
    bins: Table
    interval_us: Vector
    bin_of: NDArray[np.int64]
    notes: tuple[str, ...]


def calibrate_as_paper(
    events: NDArray[np.void],
    scene: Scene,
    keep: NDArray[np.bool_] | None = None,
    masked: Mask | Windows | None = None,
) -> PaperFit:
    """The paper's parameters from events (dtype EVENT, sorted by time) and the light that they answer to.

    keep: (H, W) pixels to use. masked: (M, 2) [us], times to leave out. Raises ValueError, in a line, where
    there are too few intervals.
    """
    found = intervals(
        events,
        scene,
        keep=np.ones((scene.height, scene.width), np.bool_) if keep is None else keep,
        masked=np.zeros((0, 2), np.int64) if masked is None else masked,
    )
    quiet = still_intervals(scene, found)
    length_us = found["end_us"] - found["start_us"]
    ended = found["end"] != 0
    quiet_rate = np.count_nonzero(quiet & ended) / max(float(length_us[quiet].sum()), 1.0)
    bins, interval_us, bin_of = interval_bins(
        length_us[ended],
        found["before"][ended].astype(np.float64),
        found["after"][ended].astype(np.float64),
        found["end"][ended] > 0,
        quiet[ended],
    )
    moving = bins[~bins["quiet"]]
    if len(np.unique(moving["on"])) < 2 or len(moving) < 6:
        raise ValueError(
            f"too few events for the paper's method: {len(moving)} bins of {FEWEST} or more same-pixel "
            "intervals under changing light. It needs 6, of both polarities: record more motion"
        )
    k1, k2, k4, k5, theta_on = drift_of(bins)
    noise, notes = _believable_noise(bins[bins["quiet"]], k2, theta_on, quiet_rate)
    changes: dict[str, Any] = {
        "contrast_response": {"k1": k1, "k2_dn": k2},
        "junction_leak": {"k4_per_us": k4},
        "parasitic_photocurrent": {"k5_per_dn_us": k5},
        "comparator": {"theta_on": theta_on, "theta_off": 1.0 / theta_on},
    }
    return PaperFit(Parameters.of("paper").changed(changes | noise), bins, interval_us, bin_of, notes)


def _believable_noise(
    quiet: Table, k2: float, theta_on: float, rate: float
) -> tuple[dict[str, Any], tuple[str, ...]]:
    """k3 and k6 as changes of parameters, unless such noise alone would exceed the rate [1/us] at which quiet
    intervals end; otherwise a note."""
    remain = "k3 and k6 stay as published"
    if len(quiet) == 0:
        return {}, (
            f"too few events under light that stands still: {remain}, k4 and k5 are from moving light",
        )
    k3, k6, noise_rate = noise_of_bins(quiet, k2, theta_on)
    if noise_rate > rate:
        seen = f"{noise_rate * 1e6:.2g} events/s where {rate * 1e6:.2g} are seen"
        return {}, (f"noise as the spread of quiet intervals has it would give {seen}: {remain}",)
    return {"photon_noise": {"k3": k3}, "leak_noise": {"k6": k6}}, ()


def fit_interval_law(interval_us: Vector) -> tuple[float, float]:
    """(|mu|/theta [1/us], sigma/theta [1/sqrt(us)]) of maximum likelihood, from intervals (n,) > 0.

    The inverse Gaussian law of mean m and shape l has m = mean(T), 1/l = mean(1/T) - 1/m; Levy's, to which
    it tends as m grows, 1/l = mean(1/T). Twice the difference of their log-likelihoods is n ln of the ratio
    of the l's; Levy's law, with mu = 0, where it is below 2.71 (5 %, one-sided).
    """
    inverse = float(np.mean(1.0 / interval_us))
    rate = 1.0 / float(np.mean(interval_us))
    excess = max(inverse - rate, 1e-12 * inverse)
    if len(interval_us) * np.log(inverse / excess) < 2.71:
        return 0.0, float(np.sqrt(inverse))
    return rate, float(np.sqrt(excess))


def interval_bins(
    interval_us: Vector, before: Vector, after: Vector, on: NDArray[np.bool_], quiet: NDArray[np.bool_]
) -> tuple[Table, Vector, NDArray[np.int64]]:
    """(bins, intervals used, the bin of each): as many intervals in each bin, so that slopes are close where
    there is much data. Where it is not quiet, only the events that go with the change of light are used.

    All (n,): intervals [us], light where they begin and end [DN], whether an ON event ends them, whether
    light stood still.
    """
    brightness, slope = 0.5 * (before + after), (after - before) / np.maximum(interval_us, 1.0)
    usable = (interval_us >= SHORTEST_US) & (quiet | (on == (slope > 0)))
    rows: list[tuple[float | bool, ...]] = []
    bin_of = np.full(len(interval_us), -1)
    for side in (True, False):
        for still in (True, False):
            chosen = np.flatnonzero(usable & (on == side) & (quiet == still))
            if still:
                parts = _parts(chosen, brightness, PER_QUIET_BIN)
            else:
                shades = _parts(chosen, brightness, max(len(chosen) // BRIGHTNESS_BINS, FEWEST))
                parts = [part for shade in shades for part in _parts(shade, slope, PER_BIN)]
            for part in (part for part in parts if len(part) >= FEWEST):
                law = fit_interval_law(interval_us[part])
                bin_of[part] = len(rows)
                rows.append((brightness[part].mean(), slope[part].mean(), side, still, len(part), *law))
    used = bin_of >= 0
    return np.array(rows, BIN), interval_us[used], bin_of[used]


def _parts(chosen: NDArray[np.int64], by: Vector, size: int) -> list[NDArray[np.int64]]:
    """The chosen indices, sorted by a value and cut into parts of at least `size`; one part of fewer."""
    ordered = chosen[np.argsort(by[chosen], kind="stable")]
    return np.array_split(ordered, max(len(ordered) // size, 1))


def drift_of(bins: Table) -> tuple[float, float, float, float, float]:
    """(k1, k2, k4, k5, theta_on), with theta_off = 1/theta_on, from dtype BIN: |mu|/theta over the bins is
    |k1/(L+k2) slope + k4 + k5 L|/theta, also for events that go against the drift. Robust, weighted by each
    bin's own error."""
    bins = bins[bins["mu"] > 0]
    level, slope, mu = bins["brightness"], bins["slope"], bins["mu"]
    side = np.where(bins["on"], 1.0, -1.0)
    error = np.hypot(bins["sigma"] / np.sqrt(mu * bins["n"]), MISFIT)

    def residual(x: Vector) -> Vector:
        k1, k2, k4, k5 = np.exp(x[:4])
        drift = np.abs(k1 / (level + k2) * slope + k4 + k5 * level) * np.exp(-side * x[4])
        return np.asarray((drift - mu) / (mu * error))

    best = least_squares(
        residual,
        np.log([5.0, 20.0, 1e-7, 1e-9, 1.0]),
        bounds=(np.log([1e-2, 0.1, 1e-12, 1e-14, 0.05]), np.log([900.0, 9e3, 1e-3, 1e-5, 20.0])),
        loss="soft_l1",
        x_scale=np.array([0.1, 0.3, 1.0, 1.0, 0.1]),
    )
    k1, k2, k4, k5, theta_on = np.exp(best.x).tolist()
    return k1, k2, k4, k5, theta_on


def noise_of_bins(quiet: Table, k2: float, theta_on: float) -> tuple[float, float, float]:
    """(k3, k6, sigma^2) from quiet bins of dtype BIN: sigma = k3 sqrt(L)/(L+k2) + k6, none negative.

    sigma^2 [1/us], the mean over the bins, is the rate at which such noise alone makes events, the product of
    the thresholds being 1.
    """
    level = quiet["brightness"]
    sigma = quiet["sigma"] * np.where(quiet["on"], theta_on, 1.0 / theta_on)
    weight = 1.0 / (sigma * np.hypot(1.0 / np.sqrt(2.0 * quiet["n"]), MISFIT))
    basis = np.column_stack([np.sqrt(level) / (level + k2), np.ones_like(level)])
    (k3, k6), _ = nnls(basis * weight[:, None], sigma * weight)
    return float(min(k3, 1.0)), float(min(k6, 1.0)), float(np.average(sigma**2, weights=quiet["n"]))
