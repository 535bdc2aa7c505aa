"""The figures to beat on two recordings that were looked at before: by published simulators, in-sample."""

from collections.abc import Mapping
from dataclasses import dataclass

from ..distances import HEADLINES, closest
from ..distances.measures import MEASURES

B4 = 0.93


@dataclass(frozen=True)
class PublishedBars:
    """published: the best of DVS-Voltmeter, ESIM and v2e in each distance, their thresholds fitted to the
    recording's own totals and judged on all of it; floor: real against real, the same way."""

    published: Mapping[str, float]
    floor: Mapping[str, float]

    def bar(self, name: str) -> float:
        """Half the way from the best published simulator to the floor; for b4 a fixed one."""
        return B4 if name == "b4" else (self.published[name] + self.floor[name]) / 2


KNOWN = {
    "slider_depth": PublishedBars(
        {"W1": 0.058, "TVs": 0.122, "pair": 0.071, "b4": 0.893, "AUC": 0.887},
        {"W1": 0.002, "TVs": 0.010, "pair": 0.002, "b4": 0.977, "AUC": 0.51},
    ),
    "davis346": PublishedBars(
        {"W1": 0.18, "TVs": 0.216, "pair": 0.17, "b4": 0.901, "AUC": 0.845},
        {"W1": 0.005, "TVs": 0.035, "pair": 0.005, "b4": 0.988, "AUC": 0.52},
    ),
}
OURS = "exact, calibrated"


def held_to(name: str, rows: Mapping[str, Mapping[str, float]], floor: Mapping[str, float]) -> str:
    """A table in Markdown: each bar, ours held out, whether it is met, and who is closest; "" where the
    recording is not a known one, or ours is not there. floor: of what was judged."""
    if name not in KNOWN or OURS not in rows:
        return ""
    known, own = KNOWN[name], rows[OURS]
    lines = [
        "| | best published, in-sample | bar | ours, held out | met | its floor here | closest |",
        "|---|---|---|---|---|---|---|",
    ]
    for measure in HEADLINES:
        best = MEASURES[measure].best or 0.0
        met = abs(own[measure] - best) <= abs(known.bar(measure) - best)
        lines.append(
            f"| {measure} | {known.published[measure]:.3g} | {known.bar(measure):.3g} | {own[measure]:.3g} | "
            f"{'yes' if met else 'no'} | {floor[measure]:.3g} | {closest(rows, measure)} |"
        )
    return "\n".join(lines)
