"""How far off `calibrate` is, and how often its intervals hold: docs/how-it-works/calibration-accuracy.md.

By `make calibration-table`: what was found of each recording is kept in results/calibration.jsonl, so an
interruption loses nothing, and the next time goes on from there. Delete that file to begin anew.

Recordings are made by tests/generator, which shares no code with the simulator: parameters drawn at random,
48 x 36 pixels, 6 s, frames in 8 bit.
"""

import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from tests.generator import draw_base, draw_scene, record

from voltcam_lab.calibration.calibrate import Calibration, Reading, calibrate, scene_between
from voltcam_lab.calibration.estimates import Estimate

NAMES = {"k2_dn": "k2", "k4_per_us": "k4", "k5_per_dn_us": "k5"}
FIRST_SEED = 300
RATES = {240: 20, 100: 10, 25: 20}  # frames a second: recordings
KEPT = Path("results/calibration.jsonl")
PAGE = Path("docs/how-it-works/calibration-accuracy.md")

TEXT = """# How well `voltcam calibrate` finds a camera

Written by `make calibration-table`; do not edit. Recordings of a camera that is known, made by
tests/generator, which shares no code with the simulator: 48 x 36 pixels, 6 s, frames in 8 bit, each parameter
off by up to 30 % from a published set, every scene another; none of them was looked at while the method was
made. Error: the median of |ln(found / true)|. Cover: how many of the 90 % intervals hold the truth.
Determined: of how many recordings the command says that the data fix the parameter; where it does not, it
says so, and the prior is what the interval shows. What is asked at 240: 10 % for k1, k2, k4, k5 and
thresholds, 20 % for k3 and k6, cover of 80 to 97 %.

What is found here are the likeliest parameters, those of `--no-refine`. No camera had a delay or a dead time;
"found" below counts the recordings in which one was reported.
"""

READ = """## Read with care

- k3 and k6 cannot be told much better: light at rest is all that shows noise. With everything else known, and
  no more than the intervals between leak events at the static pixels of these 6 s, the Cramer-Rao bound of a
  DAVIS346 is 26 % for k3 and 18 % for k6 (standard deviations; median errors of 18 and 12 %), of a DAVIS240C,
  which leaks ten times as much, 5 and 7 %; of that one, 18 and 33 % if its reset noise is not known to be
  absent, which it was not here. They go down with the root of the time recorded.
- The same pixels at rest show noise at 25 frames a second as well as at 240: it is k1, k2 and the thresholds
  that frames far apart leave open. Twins, in whose light motion is as smooth as between the recording's
  frames, do not show all of that: intervals are wider by the share of the light that frames do not tell of.
- At 25 frames a second these small recordings do not tell a delay of less than about 5 ms from none: 0 is
  then given. Dead times of 0.7 and 2 ms show at 240 and not at 25.
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


def order() -> Iterator[tuple[int, int]]:
    """(frames a second, seed), the rates mixed, so that any beginning is a small table."""
    share = [(n / count, fps, n) for fps, count in RATES.items() for n in range(count)]
    for _, fps, n in sorted(share):
        yield fps, FIRST_SEED + n


@dataclass(frozen=True)
class Kept:
    """What was found of a recording, a line of KEPT."""

    fps: int
    seed: int
    camera: str
    delay_us: float
    dead_us: float
    rows: dict[str, Row]

    def line(self) -> str:
        """As JSON."""
        return json.dumps(asdict(self)) + "\n"

    @classmethod
    def of(cls, line: str) -> "Kept":
        """From `line`."""
        content = json.loads(line)
        return cls(**(content | {"rows": {name: Row(**row) for name, row in content["rows"].items()}}))


def kept() -> list[Kept]:
    """What was found so far."""
    return [Kept.of(line) for line in KEPT.read_text("utf-8").splitlines()] if KEPT.exists() else []


def page(found: Sequence[Kept]) -> str:
    """The page of what was found so far."""
    parts = [TEXT]
    for fps, asked in RATES.items():
        here = [one for one in found if one.fps == fps]
        if not here:
            continue
        some = "" if len(here) == asked else f" (of {asked} planned)"
        late, held = (sum(bool(getattr(one, name)) for one in here) for name in ("delay_us", "dead_us"))
        parts.append(f"## {fps} frames a second, {len(here)} recordings{some}\n")
        parts.append(table([one.rows for one in here]) + "\n")
        parts.append(f"Found: a delay in {late} of {len(here)}, a dead time in {held}.\n")
    return "\n".join([*parts, READ])


def main() -> None:
    """All of it: about forty minutes on one core."""
    found = kept()
    known = {(one.fps, one.seed) for one in found}
    KEPT.parent.mkdir(exist_ok=True)
    for fps, seed in order():
        if (fps, seed) in known:
            continue
        reading, truth = reading_of(seed, fps, 6.0)
        one: Calibration = calibrate(reading, seed)
        rows = rows_of(one.estimates, truth)
        found.append(Kept(fps, seed, str(truth["camera"]), one.delay_us, one.dead_us, rows))
        with KEPT.open("a", encoding="utf-8") as file:
            file.write(found[-1].line())
        PAGE.write_text(page(found), encoding="utf-8")
        sys.stderr.write(f"{fps} fps, seed {seed}\n")
    PAGE.write_text(page(found), encoding="utf-8")


if __name__ == "__main__":
    main()
