"""Keys are sorted as NumPy sorts them."""

import numpy as np
import pytest

from voltcam_simulator.key_order import DIGIT_BITS, FEWEST, in_rising_order


@pytest.mark.parametrize("size", [0, 1, 2, FEWEST - 1, FEWEST, 20_000])
@pytest.mark.parametrize("bits", [0, 1, DIGIT_BITS, DIGIT_BITS + 1, 40, 64])
@pytest.mark.parametrize("shared", [0, 0x00F0_0000_0FF0_0F00])
def test_keys_of_any_size_come_out_as_numpy_sorts_them(size: int, bits: int, shared: int) -> None:
    """shared: bits that all keys have alike."""
    drawn = np.random.default_rng(bits).integers(0, 2**bits - 1, size, np.uint64, endpoint=True)
    keys = drawn & ~np.uint64(shared) | np.uint64(shared)
    expected = np.sort(keys)
    assert np.array_equal(in_rising_order(keys), expected)


def test_keys_that_are_all_the_same_stay() -> None:
    keys = np.full(2 * FEWEST, 2**63 + 5, np.uint64)
    assert np.array_equal(in_rising_order(keys.copy()), keys)
