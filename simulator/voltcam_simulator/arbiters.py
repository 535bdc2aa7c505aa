"""Arbiters: which of the groups that ask for the bus (rows, or columns) is granted it next."""

from typing import Any

import numpy as np

from .effect import State
from .kernel import kernel

FIRST, FAIR, GREEDY, TOKEN = range(4)
ARBITERS = ("first", "fair", "greedy", "token")


def none_asking(groups: int) -> State:
    """What arbiters keep for so many groups, G, with a tree of L >= G leaves.

    counts (G,): events that wait in each; 0: it does not ask. ring (G,): groups in the order of asking, for
    FIRST. tree (2 L,): groups that ask at or below each node, 1 the root, L + g the leaves, for FAIR and
    GREEDY; turn (L,): the side of each node that goes first where both ask. place (4,): where the ring
    begins, how many ask, which was granted last, the arbiter in force.
    """
    leaves = 1 << max(groups - 1, 1).bit_length()
    return {
        "counts": np.zeros(groups, np.int64),
        "ring": np.zeros(groups, np.int64),
        "tree": np.zeros(2 * leaves, np.int32),
        "turn": np.zeros(leaves, np.uint8),
        "place": np.zeros(4, np.int64),
    }


@kernel
def change_to(kind: Any, counts: Any, ring: Any, tree: Any) -> None:
    """Another arbiter, which finds those that ask in the order of their numbers."""
    tree[:] = 0
    asking = 0
    for group in range(counts.size):
        if counts[group] > 0:
            if kind == FIRST:
                ring[asking] = group
            elif kind != TOKEN:
                join(tree, group)
            asking += 1


@kernel
def join(tree: Any, group: Any) -> None:
    """A group that did not ask does now."""
    node = tree.size // 2 + group
    while node >= 1:
        tree[node] += 1
        node >>= 1


@kernel
def next_in_tree(kind: Any, last: Any, tree: Any, turn: Any) -> Any:
    """The group that is granted the bus and asks no more, of at least one; last: the one before.

    FAIR: of two sides of the tree that ask, the one that was not served last. GREEDY: the same below the
    smallest part of the tree about the last one in which one asks.
    """
    leaves = turn.size
    node = 1 if kind == FAIR else leaves + last
    while tree[node] == 0:
        node >>= 1
    while node < leaves:
        side = np.int64(turn[node])
        if tree[2 * node + side] == 0:
            side = 1 - side
        node = 2 * node + side
    group = node - leaves
    tree[node] -= 1
    while node > 1:
        turn[node >> 1] = 1 - (node & 1)
        node >>= 1
        tree[node] -= 1
    return group
