"""Slow twins of the arbiters, by definition, and of the bus, which serves one list of events."""

from collections.abc import Callable, Iterator
from math import ceil, log, log2

import numpy as np

from ..scenes import Events

Asking = dict[int, int]
"""Group -> number of its place in the order of asking."""


class FirstCome:
    """By the order of asking."""

    def __init__(self, groups: int) -> None:
        self.last = 0

    def next_group(self, asking: Asking) -> int:
        return min(asking, key=lambda group: asking[group])


class FairTree:
    """Halves of halves: where both have somebody that asks, that one which was not served last."""

    def __init__(self, groups: int) -> None:
        self.size = 2 ** max(ceil(log2(groups)), 1)
        self.upper_next: dict[tuple[int, int], bool] = {}
        self.last = 0

    def next_group(self, asking: Asking) -> int:
        return self._within(0, self.size, asking)

    def _within(self, begin: int, end: int, asking: Asking) -> int:
        """Of the groups from begin to end, some of which ask."""
        while end - begin > 1:
            middle = (begin + end) // 2
            lower = any(begin <= group < middle for group in asking)
            upper = any(middle <= group < end for group in asking)
            chosen = upper and (not lower or self.upper_next.get((begin, end), False))
            begin, end = (middle, end) if chosen else (begin, middle)
        self._served(begin)
        return begin

    def _served(self, group: int) -> None:
        begin, end = 0, self.size
        while end - begin > 1:
            middle = (begin + end) // 2
            self.upper_next[begin, end] = group < middle
            begin, end = (begin, middle) if group < middle else (middle, end)


class GreedyTree(FairTree):
    """The smallest part about the last one in which somebody asks comes first."""

    def next_group(self, asking: Asking) -> int:
        size = 1
        while not any(group // size == self.last // size for group in asking):
            size *= 2
        begin = self.last // size * size
        return self._within(begin, begin + size, asking)


class TokenRing:
    """The next upwards from the last, round and round."""

    def __init__(self, groups: int) -> None:
        self.groups, self.last = groups, 0

    def next_group(self, asking: Asking) -> int | None:
        if self.last in asking:
            return self.last
        self.last = (self.last + 1) % self.groups
        return None


MAKE: dict[str, Callable[[int], FirstCome | FairTree | TokenRing]] = {
    "first": FirstCome, "fair": FairTree, "greedy": GreedyTree, "token": TokenRing,
}  # fmt: skip


def served(
    events: Events, height: int, width: int, *, row_us: float, event_us: float, along: str = "rows",
    arbiter: str = "first", pass_us: float = 0, crowd: int = 0, crowded_arbiter: str = "token",
    start_us: float = 0, uniforms: Iterator[float] | None = None,
) -> Events:  # fmt: skip
    """The events as they leave the bus, all of them, with nothing left waiting. uniforms: one a start."""
    columns = along == "columns"
    usual, other = (MAKE[name](width if columns else height) for name in (arbiter, crowded_arbiter))
    if isinstance(usual, FairTree) and isinstance(other, FairTree):
        other.upper_next = usual.upper_next  # one tree, whichever way it is gone through
    at_work, come, asked = usual, 0, 0
    waiting: dict[int, dict[int, bool]] = {}
    asking: Asking = {}
    out, free_us = [], 0.0
    while asking or come < len(events):
        if not asking and events["t"][come] > free_us:
            free_us = float(events["t"][come])
            if start_us and uniforms is not None:
                free_us -= start_us * log(next(uniforms))
        now = free_us
        while come < len(events) and events["t"][come] <= np.floor(now):
            x, y = int(events["x"][come]), int(events["y"][come])
            group, member = (x, y) if columns else (y, x)
            waiting.setdefault(group, {}).setdefault(member, bool(events["p"][come]))
            asked += group not in asking
            asking.setdefault(group, asked)
            come += 1
        if crowd and len(asking) >= crowd and at_work is not other:
            other.last, at_work = at_work.last, other
            asking = {group: number for number, group in enumerate(sorted(asking))}
            asked = len(asking)
        group = at_work.next_group(asking)
        if group is None:
            free_us = now + pass_us
            continue
        at_work.last = group
        del asking[group]
        leaving = sorted(waiting.pop(group).items())
        for member, p in leaving:
            x, y = (group, member) if columns else (member, group)
            out.append((int(np.floor(now)), x, y, p))
        free_us = now + row_us + event_us * len(leaving)
        if not asking and at_work is not usual:
            usual.last, at_work = at_work.last, usual
    return np.array(out, events.dtype)
