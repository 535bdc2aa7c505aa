"""Numbers keyed by (seed, stream, interval, pixel)."""

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from voltcam_simulator.random import CROSSINGS, START, interval_key, normal, pattern, sequence, uniform

P_LIMIT = 1e-4


def uniforms(seed: int, stream: np.uint64, interval: int, pixels: int) -> NDArray[np.float64]:
    key = interval_key(seed, stream, interval)
    starts = (sequence(key, pixel) for pixel in range(pixels))
    return np.array([uniform(np.uint64(start))[1] for start in starts])


def test_neighbouring_keys_give_independent_uniform_numbers() -> None:
    base = uniforms(1, CROSSINGS, 7, 20_000)
    assert stats.kstest(base, "uniform").pvalue > P_LIMIT
    assert stats.pearsonr(base[:-1], base[1:]).pvalue > P_LIMIT
    others = [
        uniforms(2, CROSSINGS, 7, 20_000),
        uniforms(1, START, 7, 20_000),
        uniforms(1, CROSSINGS, 8, 20_000),
    ]
    for other in others:
        assert stats.kstest(other, "uniform").pvalue > P_LIMIT
        assert stats.pearsonr(base, other).pvalue > P_LIMIT


def test_a_sequence_is_uniform_and_normal_and_never_zero_or_one() -> None:
    state, values, gauss = np.uint64(3), [], []
    for _ in range(20_000):
        state, value = uniform(np.uint64(state))
        values.append(value)
        state, value = normal(np.uint64(state))
        gauss.append(value)
    assert 0 < min(values) < max(values) < 1
    assert stats.kstest(values, "uniform").pvalue > P_LIMIT
    assert stats.kstest(gauss, "norm").pvalue > P_LIMIT


def test_patterns_are_repeatable_and_apart() -> None:
    assert pattern(1, "a").random() == pattern(1, "a").random()
    assert len({pattern(seed, name).random() for seed in (1, 2) for name in "ab"}) == 4
