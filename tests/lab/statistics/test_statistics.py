"""All statistics together: what the caller counts on."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_lab.statistics import COUNTS, GROUPS, LABELS, PARTS, Setting, observe

from .streams import HEIGHT, PIXELS, WIDTH, brightening, poisson, still, stream

ADDITIVE = np.array([label.group in "ABDFGHIJ" and label.kind == "count" for label in LABELS])
ADDITIVE &= np.array(["silent" not in label.name for label in LABELS])  # of a tile's own pixels


@pytest.fixture(scope="module")
def setting() -> Setting:
    return brightening()


def test_labels_tell_every_entry_apart() -> None:
    assert len({str(label) for label in LABELS}) == len(LABELS) == len(COUNTS)
    assert [group.letter for group in GROUPS] == list("ABCDEFGHIJKL")


def test_no_events_are_an_observation_too(setting: Setting) -> None:
    values = observe(setting, stream([], [])).values
    assert values.shape == (PARTS, len(LABELS))
    assert np.isfinite(values).all()
    assert values[:, [label.group in "ABG" for label in LABELS]].sum() == 0


def test_events_outside_of_time_or_kept_pixels_are_left_out() -> None:
    keep = np.zeros((HEIGHT, WIDTH), bool)
    keep[:, : WIDTH // 2] = True
    half = still(keep=keep)
    inside = stream([1, 2, 1_000_000, 8_000_000], [0, 0, WIDTH, 2 * WIDTH])  # the first is not settled
    outside = stream([0, 8_000_001, 500_000], [0, 0, WIDTH - 1])
    both = observe(half, np.concatenate([outside, inside])).values
    np.testing.assert_array_equal(both, observe(half, inside).values)
    assert both[:, [label.group == "A" for label in LABELS]].sum() == 3


def test_time_and_pixels_are_divided_evenly() -> None:
    setting = still()
    shares = setting.seconds.sum(axis=(1, 2)) / (PIXELS * 8)
    assert setting.seconds.sum() == pytest.approx(PIXELS * 8)
    np.testing.assert_allclose(shares, 0.25, atol=0.02)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), rate_hz=st.floats(0, 20), quantum_us=st.sampled_from([1, 50, 5000]))
def test_the_order_of_events_of_one_time_does_not_matter(
    setting: Setting, seed: int, rate_hz: float, quantum_us: int
) -> None:
    rng = np.random.default_rng(seed)
    events = poisson(rng, rate_hz, 2.0, on=rng.random() < 0.5)
    events["t"] = events["t"] // quantum_us * quantum_us
    events["p"] ^= rng.random(len(events)) < 0.2
    shuffled = rng.permutation(events)
    np.testing.assert_array_equal(observe(setting, shuffled).values, observe(setting, events).values)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), rate_hz=st.floats(0, 20))
def test_the_sum_of_the_parts_is_the_whole(setting: Setting, seed: int, rate_hz: float) -> None:
    rng = np.random.default_rng(seed)
    events = poisson(rng, rate_hz, 2.0)
    events["p"] ^= rng.random(len(events)) < 0.3
    undivided = replace(
        setting, block_edges_us=setting.block_edges_us[[0, -1]], tiles=np.zeros_like(setting.tiles)
    )
    parts, whole = observe(setting, events).values, observe(undivided, events).values
    assert not whole[1:, ADDITIVE].any()
    np.testing.assert_array_equal(parts[:, ADDITIVE].sum(axis=0), whole[0, ADDITIVE])
    lag = np.array([label.group == "H" for label in LABELS])
    np.testing.assert_allclose(parts[:, lag].sum(axis=0), whole[0, lag], atol=1e-4)
