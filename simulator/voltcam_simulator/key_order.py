"""Event keys in rising order: several times as fast as a library's sort of any numbers."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .kernel import kernel

DIGIT_BITS = 11  # as many counts as the fastest memory holds
FEWEST = 1000
"""Keys; of fewer, going through the counts takes longer than a library's sort."""


def in_rising_order(keys: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """The keys, sorted; the array that was given is of no more use.

    Digit by digit, the lowest first (H. H. Seward's radix sort, 1954). Bits that all keys share are passed
    over: of a small sensor, or a short interval, few are left.
    """
    if keys.size < FEWEST:
        keys.sort()
        return keys
    other, counts = np.empty_like(keys), np.empty(1 << DIGIT_BITS, np.int64)
    return other if _sort_by_digits(keys, other, counts) else keys


@kernel
def _sort_by_digits(keys: Any, other: Any, counts: Any) -> Any:
    """Whether the sorted keys are in the other array, in the end."""
    differing = np.uint64(0)
    for i in range(keys.size):
        differing |= keys[i] ^ keys[0]
    shift, in_other = 0, False
    while shift < 64 and differing >> np.uint64(shift) != 0:
        if (differing >> np.uint64(shift)) & np.uint64(1) == 0:
            shift += 1
            continue
        _move_by_digit(keys, other, np.uint64(shift), counts)
        keys, other, in_other = other, keys, not in_other
        shift += DIGIT_BITS
    return in_other


@kernel
def _move_by_digit(keys: Any, other: Any, shift: Any, counts: Any) -> None:
    """Keys of the same digit stay in their order."""
    mask = np.uint64(counts.size - 1)
    counts[:] = 0
    for i in range(keys.size):
        counts[(keys[i] >> shift) & mask] += 1
    place = 0
    for digit in range(counts.size):
        place, counts[digit] = place + counts[digit], place
    for i in range(keys.size):
        digit = (keys[i] >> shift) & mask
        other[counts[digit]] = keys[i]
        counts[digit] += 1
