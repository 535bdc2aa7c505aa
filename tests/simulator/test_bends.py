"""Mean paths that a low pass has bent, and the straight pieces that stand for them."""

import numpy as np
import pytest
from numpy.typing import NDArray

from voltcam_simulator.bends import (
    MOST_PIECES,
    TOLERANCE,
    count_pieces,
    depth,
    fading,
    find_knots,
    straightness,
)

Floats = NDArray[np.float64]
X = np.linspace(0, 1, 20_001)


def off_the_chord(rate: float, transient: float) -> Floats:
    """By definition: transient * exp(-rate x) less the straight line between its ends, over the step."""
    curve = transient * np.exp(-rate * X)
    return np.asarray(curve - (curve[0] + (curve[-1] - curve[0]) * X))


def test_fading_is_one_less_the_root_of_what_is_left() -> None:
    rate = np.geomspace(1e-4, 200, 400).astype(np.float32)
    found = [float(fading(a)) for a in rate]
    np.testing.assert_allclose(found, -np.expm1(-rate.astype(float) / 2), rtol=4e-4)


@pytest.mark.parametrize("rate", [0.01, 0.3, 1, 3, 10, 40, 300])
def test_the_bow_is_the_largest_distance_from_the_chord(rate: float) -> None:
    assert float(depth(np.float32(rate))) == pytest.approx(-off_the_chord(rate, 1.0).min(), rel=0.03)


def knots_of(bow: float, drift: float, rate: float, span_us: float) -> tuple[Floats, Floats]:
    """(share of the step, distance from the chord) at the ends of the pieces of one path, by the kernels."""
    columns = [np.array([value], np.float32) for value in (bow, drift, fading(np.float32(rate)), rate)]
    bows, drifts, q, rates = columns
    pieces = np.empty(1, np.float32)
    most = count_pieces(bows, drifts, rates, q, span_us, pieces)
    assert most == pieces[0]
    shares, lines = [0.0], [0.0]
    for number in range(1, most + 1):
        share, line = np.empty((2, 1), np.float32)
        find_knots(number, pieces, rates, q, share, line, np.empty(1, np.float32))
        shares.append(float(share[0]))
        lines.append(float(line[0]) * bow)
    return np.array(shares), np.array(lines)


@pytest.mark.parametrize("rate", [0.05, 0.7, 2, 8, 30])
@pytest.mark.parametrize("transient", [0.02, -0.3, 1.5])
@pytest.mark.parametrize("drift", [0.0, 0.4, -3.0])
def test_pieces_keep_to_the_path_within_the_tolerance(rate: float, transient: float, drift: float) -> None:
    span_us = 33_000.0
    bow = float(-depth(np.float32(rate)) * transient)
    shares, lines = knots_of(bow, drift, rate, span_us)
    away = off_the_chord(rate, transient)
    assert shares[0] == 0
    assert shares[-1] == 1
    assert lines[-1] == 0
    assert (np.diff(shares) > 0).all()
    allowed = max(TOLERANCE, abs(drift) / 64)
    worst = np.abs(np.interp(X, shares, lines) - away).max()
    if len(shares) - 1 < MOST_PIECES:
        assert worst <= 1.1 * allowed
    if len(shares) > 2:  # and no more pieces than it takes
        assert worst > 0.3 * allowed


def test_half_a_millisecond_is_as_straight_as_a_short_step_must_be() -> None:
    assert straightness(4000.0) == (np.float32(TOLERANCE), np.float32(1 / 8))
    assert straightness(100_000.0)[1] == np.float32(1 / 64)
    assert straightness(400.0)[1] > 1  # all of it


def test_a_path_that_never_ends_bending_has_pieces_enough() -> None:
    """A bow of a hundred thresholds is cut, not refused."""
    shares, _ = knots_of(100.0, 0.0, 2.0, 33_000.0)
    assert len(shares) == MOST_PIECES + 1


def test_paths_of_a_block_have_their_own_pieces() -> None:
    """Those that are done stay at the end of the step."""
    q, rate = np.array([fading(np.float32(2.0))] * 2, np.float32), np.full(2, 2, np.float32)
    bow = np.array([0.005, 0.06], np.float32)
    pieces = np.empty(2, np.float32)
    assert count_pieces(bow, np.zeros(2, np.float32), rate, q, 33_000.0, pieces) == 3
    assert pieces.tolist() == [1, 3]
    share, line = np.empty((2, 2), np.float32)
    find_knots(1, pieces, rate, q, share, line, np.empty(2, np.float32))
    assert share[0] == 1
    assert 0 < share[1] < 1 / 3  # dense where the path is bent most
    assert line[1] > 0.5
