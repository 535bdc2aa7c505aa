"""The processors that kernels are compiled ahead for, and which of them this machine can stand in for."""

from typing import NamedTuple


class Target(NamedTuple):
    """A level of x86-64. name, features: as LLVM takes them. needs: what a processor must have to run it."""

    name: str
    features: str
    needs: frozenset[str]


_V3 = frozenset(
    ["+avx2", "+bmi", "+bmi2", "+cx16", "+f16c", "+fma", "+lzcnt", "+movbe", "+popcnt", "+sse4.2", "+xsave"]
)
_V4 = _V3 | frozenset(["+avx512bw", "+avx512cd", "+avx512dq", "+avx512f", "+avx512vl"])

TARGETS = (
    Target("x86-64-v4", "-prefer-256-bit", _V4),  # else LLVM uses half of each register: 13 % slower
    Target("x86-64-v3", "", _V3),
)
"""The best one first."""


def best_target(features: str) -> Target | None:
    """The best target for a processor with these features, as LLVM lists them: "+avx2,-xop"; None: none."""
    has = set(features.split(","))
    return next((target for target in TARGETS if target.needs <= has), None)
