"""What the baselines share: frames in, events in order out, and thresholds that are drawn."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import norm

from voltcam_lab.models.frame_pixels import SMALLEST_THRESHOLD, FramePixels, Keys, Plane, mismatched
from voltcam_simulator import EVENT

TIME, Y, X = 27, 14, 1
"""Bits of an event key to the right of each; polarity is the last."""


class Brighter(FramePixels):
    """A pixel gives an ON event half-way to a brighter frame, an OFF event at the end of a darker one."""

    seen: NDArray[np.float64]

    def _settle(self, light: Plane) -> None:
        self.seen = light

    def _step(self, light: Plane, start_us: int, span_us: int) -> Keys:
        change = np.sign(light - self.seen)
        self.seen = light
        y, x = np.divmod(np.flatnonzero(change), self.width)
        on = change[change != 0] > 0
        after = np.where(on, span_us // 2, span_us)
        key = after << TIME | y << Y | x << X | on
        return key.astype(np.uint64)


def test_events_come_in_order_with_their_own_places() -> None:
    model = Brighter(3, 2)
    assert model.advance([[1, 2, 3], [4, 5, 6]], 1_700_000_000_000_000).size == 0
    events = model.advance([[0, 2, 9], [4, 9, 6]], 1_700_000_000_001_000)
    assert events.dtype == EVENT
    begin = 1_700_000_000_000_000
    assert events.tolist() == [
        (begin + 500, 2, 0, True), (begin + 500, 1, 1, True), (begin + 1000, 0, 0, False),
    ]  # fmt: skip


def test_what_is_refused_leaves_the_sensor_as_it_was() -> None:
    model = Brighter(3, 2)
    dark, bright = np.zeros((2, 3)), np.ones((2, 3))
    model.advance(dark, 100)
    with pytest.raises(ValueError, match=r"\(3, 2\).*\(height, width\) = \(2, 3\)"):
        model.advance(bright.T, 200)
    for t_us in (100, 50):
        with pytest.raises(ValueError, match="does not come after the last one at 100 us"):
            model.advance(bright, t_us)
    assert model.advance(dark, 200).size == 0
    assert model.advance(bright, 300).size == 6


def test_thresholds_are_normal_and_no_smaller_than_the_published_tools_have_them() -> None:
    """Of 40 000, to 4.5 standard errors: another seed would fail once in 100 000 times."""
    n, theta, sigma = 40_000, 0.03, 0.02
    drawn = mismatched(np.random.default_rng(1), theta, sigma, n)
    assert drawn.min() == SMALLEST_THRESHOLD
    clipped = norm.cdf(SMALLEST_THRESHOLD, theta, sigma)
    assert np.mean(drawn == SMALLEST_THRESHOLD) == pytest.approx(
        clipped, abs=4.5 * np.sqrt(clipped * (1 - clipped) / n)
    )
    assert np.quantile(drawn, 0.8) == pytest.approx(
        norm.ppf(0.8, theta, sigma), abs=4.5 * sigma * 1.43 / n**0.5
    )
    assert (mismatched(np.random.default_rng(1), theta, 0, 5) == theta).all()
