"""Which arbiter a bus has, from the order in which rows leave while it is never idle.

If all rows ask at once, each arbiter has an order of its own. A token goes upwards; a greedy tree ends a
part before it leaves it; a fair tree changes sides; the first come in any order. Rows ask at any time, so no
order is perfect. A score says how far it is from chance (0: the same rows shuffled) to perfect (1).
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator.effects.readout import Arbiter

Order = NDArray[np.int64]
"""Rows as they leave in one stretch."""
FEWEST_ROWS = 8
SHUFFLES = 10
CLEAR = 0.5
"""Score from which an arbiter is told: the order is nearer to its perfect one than to chance."""


def arbiter_of(orders: Sequence[Order], rows: int) -> Arbiter:
    """The arbiter that has these orders, of a sensor of so many rows; "first" where none is told.

    A token's order is a greedy tree's, too, so it is asked for first.
    """
    long = [order for order in orders if len(order) >= FEWEST_ROWS]
    if _score(long, lambda order: float((np.diff(order) % rows).mean()), np.sort) > CLEAR:
        return "token"
    if _score(long, _mean_height, np.sort) > CLEAR:
        return "greedy"
    return "fair" if _score(long, _mean_height, _by_turns) > CLEAR else "first"


def _score(
    orders: Sequence[Order], measure: Callable[[Order], float], perfect: Callable[[Order], Order]
) -> float:
    rng = np.random.default_rng(0)
    possible = gained = 0.0
    for order in orders:
        chance = float(np.mean([measure(rng.permutation(order)) for _ in range(SHUFFLES)]))
        possible += chance - measure(perfect(order))
        gained += chance - measure(order)
    return gained / possible if possible else 0.0


def _mean_height(order: Order) -> float:
    """Of the smallest part of the tree that has a row and the next one."""
    return float(np.frexp((order[1:] ^ order[:-1]).astype(np.float64))[1].mean())


def _by_turns(order: Order) -> Order:
    """The same rows as a fair tree serves them that ask at once: sides in turn, and so within each side."""
    rows = np.sort(order)
    top = int(rows[0] ^ rows[-1]) if len(rows) else 0
    if top == 0:
        return rows
    upper_side = (rows >> (top.bit_length() - 1) & 1) == 1
    lower, upper = _by_turns(rows[~upper_side]), _by_turns(rows[upper_side])
    both = min(len(lower), len(upper))
    turns = np.stack([lower[:both], upper[:both]], axis=1).ravel()
    return np.concatenate([turns, lower[both:], upper[both:]])
