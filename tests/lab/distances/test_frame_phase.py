"""Phases of the frame: what crowds at one phase is seen, whatever else happens."""

import numpy as np
import pytest
from tests.lab.distances.made import WHOLE, poisson, still_light

from voltcam_lab.distances.frame_phase import PHASES, phase_shares, phase_variation

LIGHT = still_light()


def test_a_poisson_stream_has_no_phase() -> None:
    shares = phase_shares(poisson(2, rate_hz=60), WHOLE, LIGHT)
    assert shares.shape == (2, PHASES)
    assert shares.sum() == pytest.approx(1)
    assert phase_variation(shares, np.full((2, PHASES), 1 / (2 * PHASES))) < 0.03


def test_events_moved_to_one_phase_differ_by_their_share() -> None:
    """A fifth of the events all at one phase: the total variation is that fifth, less what was there."""
    events = poisson(3, rate_hz=60)
    moved = events.copy()
    chosen = np.arange(len(events)) % 5 == 0
    number = LIGHT.interval_of(events["t"])
    moved["t"][chosen] = LIGHT.t_us[number[chosen]] + 1
    found = phase_variation(phase_shares(events, WHOLE, LIGHT), phase_shares(moved, WHOLE, LIGHT))
    assert found == pytest.approx(0.2 * (1 - 1 / PHASES), abs=0.02)
