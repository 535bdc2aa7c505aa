"""Items that someone should look at: far from the others, or as no camera would give."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .manifest import Record

FAR = 3.5
"""From the median, in median absolute deviations scaled to a normal's: Iglewicz and Hoaglin 1993."""

MAD_OF_NORMAL = 0.6745
ONE_SIDED = 0.95  # share of ON, or of OFF, beyond which a clip only brightens, darkens, or is wrongly read
LEAST_EVENTS = 100  # with fewer, a share says nothing


@dataclass(frozen=True)
class Outlier:
    """why: in words, without the item's name."""

    record: Record
    why: str


def outliers(records: Sequence[Record]) -> list[Outlier]:
    """Of items that were made, those that stand out most first."""
    rates = np.array([pixel_rate(record) for record in records])
    found = list[tuple[float, Outlier]]()
    far = distances(rates)
    for record, rate, distance in zip(records, rates.tolist(), far.tolist(), strict=True):
        share = record["on"] / max(record["events"], 1)
        if record["events"] == 0:
            found.append((np.inf, Outlier(record, "it has no event")))
        elif abs(distance) > FAR:
            side = "many" if distance > 0 else "few"
            found.append(
                (abs(distance), Outlier(record, f"{side} events for this set: {rate:.3g} a second and pixel"))
            )
        elif record["events"] >= LEAST_EVENTS and not 1 - ONE_SIDED < share < ONE_SIDED:
            found.append((0.0, Outlier(record, f"{share:.0%} of its events are ON")))
    return [outlier for _, outlier in sorted(found, key=lambda one: -one[0])]


def pixel_rate(record: Record) -> float:
    """Events a second and pixel."""
    return float(record["events_per_s"] / (record["width"] * record["height"]))


def distances(rates: np.ndarray) -> np.ndarray:
    """From the median of the logarithms, in robust standard deviations; 0 where all are alike. Those without
    an event do not count."""
    with np.errstate(divide="ignore"):
        logs = np.log(rates)
    good = np.isfinite(logs)
    if not good.any():
        return np.zeros_like(logs)
    middle = np.median(logs[good])
    spread = np.median(np.abs(logs[good] - middle)) / MAD_OF_NORMAL
    return np.where(good, (logs - middle) / max(spread, 0.05), 0.0)  # 5 %: all alike is no reason
