"""Group K: events that the law's leak and change of light ask for leave nothing; what is more shows."""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_lab.light.known import KnownLight
from voltcam_lab.statistics import Setting
from voltcam_lab.statistics.stream import stream_of
from voltcam_simulator import Parameters

from .streams import PERIOD_US, PIXELS, WIDTH, Events, brightening, seen, still, stream

NET, SQUARED = "net events", "net events squared"
LEAK = Parameters.of("typical").changed({
    "junction_leak": {"k4_per_us": 2e-6}, "parasitic_photocurrent": {"k5_per_dn_us": 0},
})  # fmt: skip
HALF_US = 4_000_000
EVERY = np.arange(PIXELS)


@pytest.fixture(scope="module")
def rest() -> Setting:
    return still(8.0, parameters=LEAK)


def leaking(rate_hz: object, number: int = 7) -> Events:
    """So many ON events of each pixel in each half of 8 s, that come evenly."""
    rate = np.broadcast_to(rate_hz, PIXELS)
    once = 1e5 + 1e6 * np.arange(number) / rate[:, None]
    return stream(np.hstack([once, HALF_US + once]).astype(np.int64), EVERY[:, None])


def test_what_the_law_asks_for_leaves_nothing(rest: Setting) -> None:
    """Two events a second; six after the first one take three seconds."""
    assert abs(seen(rest, leaking(2.0), "K", NET).sum()) < 1e-3
    assert seen(rest, leaking(2.0), "K", SQUARED).sum() < 1e-6
    one_more = np.concatenate([leaking(2.0), stream([1_500_001], [5])])
    assert seen(rest, one_more, "K", NET).sum() == pytest.approx(1.0, abs=0.01)


def test_events_are_counted_after_the_first_one_of_a_half_up_to_its_last(rest: Setting) -> None:
    t_us = [10, 20, 30, HALF_US, HALF_US + 1, HALF_US + 2, HALF_US + 3, 8_000_000]
    on = [True, True, False, True, False, True, True, False]
    found = stream_of(rest, stream(t_us, 3, on))
    assert found.ends[:, :, 3].tolist() == [[0, 3], [4, 7]]
    assert found.between[:, :, 3].tolist() == [[1, 2], [1, 2]]
    alone = stream_of(rest, stream([10, HALF_US + 1], 3))
    assert (alone.ends == -1).all()
    assert not alone.between.any()


def test_change_of_light_counts_from_event_to_event() -> None:
    """ln(L + k2) rises by 1.15 a second. Without leak k1 times that is what events come at."""
    law = LEAK.changed({"junction_leak": {"k4_per_us": 0}})
    setting = replace(brightening(2.0, 1.15), parameters=law)
    every_us = 1e6 / (1.15 * law.contrast_response.k1)
    events = stream((1e4 + every_us * np.arange(11)).astype(np.int64), EVERY[:, None])
    begin, end = (np.searchsorted(events["t"][:11], t_us) for t_us in (0, 1_000_000))
    assert end - begin > 5
    assert np.abs(seen(setting, events, "K", NET)).max() < 0.02 * PIXELS / 6
    assert seen(setting, np.concatenate([events, events]), "K", NET).sum() > 5 * PIXELS


def test_light_in_between_need_not_be_known(rest: Setting) -> None:
    """It is known at the first and last event only. All events count, and none of them does elsewhere."""
    events = leaking(2.4)
    gap = np.isin(np.arange(len(rest.known.gaps)), events["t"][[0, 6, 7, 13]] // PERIOD_US)
    known = KnownLight(np.broadcast_to(gap[:, None], rest.known.gaps.shape), rest.known.taken_us, WIDTH)
    blind = replace(rest, known=known)
    assert seen(blind, events, "A", "events").sum() < 4.1 * PIXELS
    np.testing.assert_allclose(seen(blind, events, "K", NET), seen(rest, events, "K", NET), atol=1e-6)
    assert seen(rest, events, "K", NET).sum() == pytest.approx(2 * PIXELS * (6 - 2 * 6 / 2.4), rel=1e-3)


def test_leaks_that_differ_show_in_the_squares(rest: Setting) -> None:
    """Six events are 1.5 too few, or one too many. What fits best to all of them is leak, and taken off."""
    spread = seen(rest, leaking(np.where(EVERY % 2, 1.6, 2.4)), "K", SQUARED).sum()
    assert seen(rest, leaking(2.4), "K", SQUARED).sum() < 1e-6
    span_s, beyond = np.array([6 / 1.6, 6 / 2.4]), np.array([-1.5, 1.0])
    left = beyond - span_s * (span_s @ beyond) / (span_s @ span_s)
    assert spread == pytest.approx(PIXELS * (left**2).sum(), rel=1e-3)


def test_a_hot_pixel_does_not_drown_the_others(rest: Setting) -> None:
    hot = np.concatenate([leaking(2.0), stream(np.arange(200_000, 3_000_000, 10_000), 5)])
    assert seen(rest, hot, "K", NET).sum() == pytest.approx(8.0, abs=0.5)
    assert seen(rest, hot, "K", SQUARED).sum() == pytest.approx(64.0, abs=1)


def test_more_light_is_more_leak() -> None:
    """Half of the pixels are twice as bright, and so have twice as many events."""
    law = LEAK.changed({
        "junction_leak": {"k4_per_us": 0}, "parasitic_photocurrent": {"k5_per_dn_us": 2e-8},
    })  # fmt: skip
    grey = still(8.0, grey=100.0, parameters=law)
    assert abs(seen(grey, leaking(2.0), "K", NET).sum()) < 0.01 * PIXELS
    assert seen(grey, leaking(4.0), "K", NET).sum() == pytest.approx(2 * PIXELS * 3, rel=0.01)


def test_no_events_leave_nothing(rest: Setting) -> None:
    assert not seen(rest, stream([], []), "K", NET).any()
