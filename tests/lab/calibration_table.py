"""How far off `calibrate` is, and how often its intervals hold: docs/calibration.md.

By `make calibration-table`.

Recordings are made by tests/generator, which shares no code with the simulator: parameters drawn at random,
48 x 36 pixels, 6 s, frames in 8 bit.
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tests.generator import draw_base, draw_scene, record

from voltcam_lab.calibrate import Reading, calibrate, scene_between
from voltcam_lab.estimates import Estimate

NAMES = {"k2_dn": "k2", "k4_per_us": "k4", "k5_per_dn_us": "k5"}
FIRST_SEED = 100
RATES = {240: 20, 100: 10, 25: 20}  # frames a second: recordings

TEXT = """# How well `voltcam calibrate` finds a camera

Written by `make calibration-table`; do not edit. Recordings of a camera that is known, made by
tests/generator, which shares no code with the simulator: 48 x 36 pixels, 6 s, frames in 8 bit, each parameter
off by up to 30 % from a published set, every scene another. Error: the median of |ln(found / true)|. Cover:
how many of the 90 % intervals hold the truth. Determined: of how many recordings the command says that the
data fix the parameter; where it does not, it says so, and the prior is what the interval shows.
"""


@dataclass(frozen=True)
class Row:
    """error: ln(found / true). wide: half the 90 % interval, of the logarithm."""

    error: float
    wide: float
    determined: bool


def reading_of(seed: int, fps: float, seconds: float) -> tuple[Reading, dict[str, float]]:
    """(a recording, the true parameters by the generator's names)."""
    rng = np.random.default_rng(seed)
    scene, base = draw_scene(rng), draw_base(rng)
    made = record(scene, base, seed=seed, fps=fps, seconds=seconds)
    light = scene_between(made.frames, made.frame_t_us)
    keep, masked = np.ones((made.height, made.width), np.bool_), np.zeros((0, 2), np.int64)
    return Reading(made.events, light, keep, masked), made.truth["base"]


def rows_of(estimates: Sequence[Estimate], truth: dict[str, float]) -> dict[str, Row]:
    """What was drawn, beside what was found."""
    rows = {}
    for one in estimates:
        name = NAMES.get(one.parameter, one.parameter)
        if name in truth:
            error, wide = np.log(one.value / truth[name]), np.log(one.high / one.low) / 2
            rows[name] = Row(float(error), float(wide), one.determined)
    return rows


def table(found: Sequence[dict[str, Row]]) -> str:
    """In Markdown."""
    lines = ["| | error | bias | interval | cover | determined |", "|---|---|---|---|---|---|"]
    for name in found[0]:
        rows = [each[name] for each in found]
        error = np.array([row.error for row in rows])
        wide = np.array([row.wide for row in rows])
        cover, fixed = np.mean(np.abs(error) <= wide), np.mean([row.determined for row in rows])
        lines.append(
            f"| {name} | {np.median(np.abs(error)):.1%} | {np.median(error):+.1%} | ±{np.median(wide):.1%} "
            f"| {cover:.0%} | {fixed:.0%} |"
        )
    return "\n".join(lines)


def main() -> None:
    """All of it: about an hour and a half on one core."""
    parts = [TEXT]
    for fps, recordings in RATES.items():
        found = []
        for seed in range(FIRST_SEED, FIRST_SEED + recordings):
            reading, truth = reading_of(seed, fps, 6.0)
            found.append(rows_of(calibrate(reading, seed).estimates, truth))
            sys.stderr.write(f"{fps} fps, seed {seed}\n")
        parts.append(f"## {fps} frames a second, {recordings} recordings\n\n{table(found)}\n")
    Path("docs/calibration.md").write_text("\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
