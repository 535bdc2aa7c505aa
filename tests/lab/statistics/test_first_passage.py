"""Group J against intervals drawn from the law itself, and from what breaks it in three ways."""

import numpy as np
import pytest

from voltcam_lab.statistics.first_passage import PROBABILITY_EDGES
from voltcam_simulator import Parameters

from .streams import PIXELS, Events, brightening, seen, still, stream

PER_S = 1.15
PER_EVENT_S = 1 / (5.265 * PER_S)  # threshold 1
EVENTS = 11  # of a pixel, within 2 s


def test_brownian_intervals_have_even_probabilities() -> None:
    """A leak of 2 thresholds a second with sigma^2 = .5/s: inverse Gaussian, mean .5 s, shape 2 s."""
    law = Parameters.of("typical").changed({
        "photon_noise": {"k3": 0}, "parasitic_photocurrent": {"k5_per_dn_us": 0},
        "junction_leak": {"k4_per_us": 2e-6}, "leak_noise": {"k6": 5e-7**0.5},
    })  # fmt: skip
    intervals_us = np.random.default_rng(1).wald(5e5, 2e6, (PIXELS, 5))
    t_us = 1 + np.cumsum(np.hstack([np.zeros((PIXELS, 1)), intervals_us]), axis=1).astype(np.int64)
    assert t_us.max() < 8_000_000  # else the short ones would be favoured
    setting = still(parameters=law)
    n = seen(setting, stream(t_us, np.arange(PIXELS)[:, None]), "J", "intervals", "ON", "rest")
    p = np.diff([0, *PROBABILITY_EDGES, 1])
    assert n.sum() == intervals_us.size
    assert (np.abs(n - n.sum() * p) < 4.5 * np.sqrt(n.sum() * p * (1 - p)) + 0.005 * n.sum()).all()


def rising(theta: object, late_s: object = 0.0) -> Events:
    """Events of a brightening without noise: each interval takes theta thresholds, and is seen late."""
    intervals_s = PER_EVENT_S * np.broadcast_to(theta, (PIXELS, EVENTS))
    t_us = 1e6 * (0.01 + np.cumsum(intervals_s, axis=1) + late_s)
    return stream(t_us.astype(np.int64), np.arange(PIXELS)[:, None])


@pytest.mark.parametrize(
    ("what", "expected"), [("mismatch", (EVENTS - 2) / (EVENTS - 1)), ("reset noise", 0.0), ("jitter", -0.45)]
)
def test_products_tell_what_lasts_from_what_is_new_and_from_late_stamps(what: str, expected: float) -> None:
    rng = np.random.default_rng(2)
    events = {
        "mismatch": lambda: rising(1 + 0.05 * rng.standard_normal((PIXELS, 1))),
        "reset noise": lambda: rising(1 + 0.05 * rng.standard_normal((PIXELS, EVENTS))),
        "jitter": lambda: rising(1.0, 0.04 * PER_EVENT_S * rng.standard_normal((PIXELS, EVENTS))),
    }[what]()
    setting = brightening(2.0, PER_S)
    products = seen(setting, events, "J", "excess times the one before", "ON").sum()
    squares = seen(setting, events, "J", "excess squared", "ON").sum()
    assert products / squares == pytest.approx(expected, abs=0.1)  # 1/sqrt(432 x 9) = .016 of chance
