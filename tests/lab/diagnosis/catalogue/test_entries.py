"""The catalogue of effects that may be missing."""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_lab.diagnosis.catalogue.entries import (
    ENTRIES,
    acts_across_columns,
    catalogue,
    in_words,
    next_recording,
)
from voltcam_lab.diagnosis.catalogue.thresholds import ThresholdRatio
from voltcam_lab.models.exact import IN_THRESHOLDS, K1_TO_K6
from voltcam_simulator import EVENT, Parameters
from voltcam_simulator.effects import EFFECTS

from ..made_rig import made_clues

CLUES = made_clues()
SCALED = [K1_TO_K6[name] for name in IN_THRESHOLDS]
INPUT_AND_BASE = {
    "contrast_response", "photon_noise", "junction_leak", "parasitic_photocurrent", "leak_noise",
    "dark_current", "residual_drift", "residual_noise", "residual_kick", "residual_coupling",
    "residual_clock", "residual_pattern", "frame_noise",
}  # fmt: skip
ONLY_WHERE_SEEN = {"arbiter_scan", "row_request"}


def test_every_effect_of_the_registry_can_be_found() -> None:
    assert {one.effect for one in catalogue(CLUES)} == (
        {effect.name for effect in EFFECTS} - INPUT_AND_BASE - ONLY_WHERE_SEEN
    )


def test_a_token_is_looked_for_where_stamps_show_one() -> None:
    """All 36 rows in turn, again and again, an event in each 10 us: a round of 360 us."""
    events = CLUES.events.copy()
    events["t"], events["y"] = 10 * np.arange(len(events)), np.arange(len(events)) % 36
    (token,) = [one for one in catalogue(replace(CLUES, events=events)) if one.effect == "arbiter_scan"]
    assert token.sizes[0][0] == pytest.approx(360, rel=0.05)
    assert token.on(Parameters.of("paper"), token.sizes[0]).arbiter_scan.active


def test_a_row_that_asks_late_is_looked_for_where_stamps_show_it() -> None:
    """20 000 events of rows that ask at random; of one that asked in the last 10 us there is none again."""
    events = np.zeros(20_000, EVENT)
    rng = np.random.default_rng(1)
    events["t"], events["y"] = (
        np.sort(rng.integers(0, 400_000, len(events))),
        rng.integers(0, 36, len(events)),
    )
    assert "row_request" not in {one.effect for one in catalogue(replace(CLUES, events=events))}
    order = np.lexsort((events["t"], events["y"]))
    late = order[1:][(np.diff(events["t"][order]) < 10) & (np.diff(events["y"][order].astype(int)) == 0)]
    (candidate,) = [
        one
        for one in catalogue(replace(CLUES, events=np.delete(events, late)))
        if one.effect == "row_request"
    ]
    assert 2 < candidate.sizes[0][0] < 40
    assert candidate.on(Parameters.of("paper"), candidate.sizes[0]).row_request.active


@pytest.mark.parametrize("candidate", catalogue(CLUES), ids=lambda one: f"{one.effect}-{one.names[0]}")
def test_each_candidate_switches_its_effect_on_and_nothing_else(candidate) -> None:  # type: ignore[no-untyped-def]
    before = Parameters.of("paper")
    with_it = {effect for effect, _ in SCALED} if isinstance(candidate, ThresholdRatio) else set()
    for size in candidate.sizes:
        after = candidate.on(before, size)
        changed = {e.name for e, f in zip(before.effects(), after.effects(), strict=True) if e != f}
        assert changed == {candidate.effect} | with_it
        assert getattr(after, candidate.effect).active


def test_each_effect_has_one_entry_and_the_entry_its_own_candidates() -> None:
    assert len({entry.effect for entry in ENTRIES}) == len(ENTRIES)
    for entry in ENTRIES:
        assert {one.effect for one in entry.candidates(CLUES)} <= {entry.effect}
        assert entry.best_shown_by


@pytest.mark.parametrize(
    ("effect", "sizes"),
    [
        ("readout", {"event_us": 10}),
        ("residual_drift", {"per_us": 1e-6, "across": 0.5}),
        ("usb_overflow", {"max_rate_events_per_s": 1e5}),
        ("vignetting", {"corner_loss": 0.5}),
    ],
)
def test_effects_that_the_columns_share(effect: str, sizes: dict[str, float]) -> None:
    assert not acts_across_columns(Parameters.of("paper"))
    assert acts_across_columns(Parameters.of("paper").changed({effect: sizes}))


def test_rivals_are_told_apart_by_what_shows_either() -> None:
    found = next_recording("hot_pixels", ["dead_pixels", "reset_noise"])
    assert found == (
        "half a minute with the lens cap on, after some motion; and the same slow motion back and forth over"
        " every pixel, many times"
    )
    assert in_words("hot_pixels") == "hot pixels"
    assert in_words("comparator") == "unequal thresholds"
