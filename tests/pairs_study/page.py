"""docs/how-it-works/camera-pairs.md: what came of the pairs, whatever it is."""

from collections.abc import Sequence

import numpy as np

from .judge import MEASURED, Outcome
from .pairs import APART, FPS, LIGHT, REPORTED_FROM, Pair

RATIO, DELAY_US = 1.5, 1000.0  # what is asked


def page(pairs: Sequence[Pair], outcomes: Sequence[Outcome]) -> str:
    """Markdown, of all pairs that have an outcome."""
    kinds = {pair.seed: pair for pair in pairs}
    found = sorted((one for one in outcomes if one.seed in kinds), key=lambda one: one.seed)
    sections = [_head(pairs, found), "## What was asked, and what was reached", _asked(found)]
    sections += ["## Pair by pair", _EACH, _each(found, kinds)]
    if failed := [one for one in found if one.error]:
        lines = [f"{one.seed}: {' '.join(one.error.split())}" for one in failed]
        sections += ["## Errors", "\n".join(["```text", *lines, "```"])]
    return "\n\n".join(sections) + "\n"


_EACH = """\
Each distance: calibrated, the same without refinement, true values, the camera's own second run. Fine: which
of the scenes have a finer texture. Late: how much later simulated events are than recorded ones, with the
calibrated file and with the true one. ON and OFF are of the recorded."""


def _head(pairs: Sequence[Pair], found: Sequence[Outcome]) -> str:
    one = pairs[0]
    left = "" if len(found) == len(pairs) else f" **Not finished: {len(found)} of {len(pairs)} have run.**"
    reported = one.seed >= REPORTED_FROM
    use = "the report's" if reported else f"for development; the report's begin at {REPORTED_FROM}"
    versions = sorted({outcome.code for outcome in found if outcome.code})
    return f"""# One camera, two recordings

Written by `make pairs`; not by hand.{left}

A camera is drawn at random and records two scenes of {one.seconds:g} s and {one.width} x {one.height} pixels.
Their light differs by {APART:g} times or more ({LIGHT[0]:g} to {LIGHT[1]:g} of the scene's own).
Frames have 8 bits, at {FPS[0]:g} to {FPS[1]:g} a second.
`calibrate` sees the first recording only. The camera found is shown the frames of the second, with
`--upsample auto`, and its events are held against those that the hidden camera gave there.
So are the events of a camera file with the true values, and those of a second run of the hidden camera.

Cameras are made by `tests/generator`, which shares no code with simulator and lab. They have spread
thresholds and leaks, reset noise, dead time, low pass, and shot noise. They have coupling, hot pixels, kicks
of exposure and readout, latency with jitter, and an arbiter that goes round.
Seeds are {one.seed} to {pairs[-1].seed}, {use}.
Sources of simulator, lab, generator and light between frames: {", ".join(versions) or "none yet"}."""


def _asked(found: Sequence[Outcome]) -> str:
    good = [one for one in found if not one.error]
    lines = ["| | asked of each | median | worst | within |", "|---|---|---|---|---|"]
    if not good:
        return "Nothing has run."
    for name in MEASURED:
        ratios, likeliest = (np.array([one.ratio(name, way) for one in good]) for way in (False, True))
        lines.append(
            _line(f"{name}, over that of the true values", f"at most {RATIO:g}", ratios, RATIO, len(found))
        )
        lines.append(_line("the same without refinement", "", likeliest, RATIO, len(found)))
    late = np.abs([one.late_us for one in good]) / 1000
    anyway = np.abs([one.true.lag_us for one in good if one.true is not None]) / 1000
    wrong = np.abs([one.delay_us - one.true_delay_us for one in good]) / 1000
    most = DELAY_US / 1000
    lines.append(_line("events late or early, ms", f"at most {most:g}", late, most, len(found)))
    lines.append(_line("the same with the true values", "", anyway, most, len(found)))
    lines.append(_line("`latency.delay_us`, off by ms", f"at most {most:g}", wrong, most, len(found)))
    return "\n".join(lines)


def _line(what: str, asked: str, values: "np.ndarray", most: float, count: int) -> str:
    within = int(np.count_nonzero(values <= most))
    return f"| {what} | {asked} | {np.median(values):.2f} | {values.max():.2f} | {within} of {count} |"


def _each(found: Sequence[Outcome], pairs: dict[int, Pair]) -> str:
    lines = [
        "| seed | fine | frames/s | W1 | TVs | pair | late, ms | ON, OFF |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for one in found:
        if one.true is None or one.calibrated is None or one.likeliest is None or one.again is None:
            continue
        pair = pairs[one.seed]
        fine = ", ".join(name for name, so in zip(("first", "second"), pair.fine, strict=True) if so)
        rows = one.calibrated, one.likeliest, one.true, one.again
        cells = [", ".join(f"{getattr(row, name):.3f}" for row in rows) for name in MEASURED]
        late = f"{one.calibrated.lag_us / 1000:+.1f}, {one.true.lag_us / 1000:+.1f}"
        totals = f"{one.calibrated.on:.2f}, {one.calibrated.off:.2f}"
        fps = f"{1e6 / pair.camera.frame_us:.0f}"
        lines.append(f"| {' | '.join([str(one.seed), fine, fps, *cells, late, totals])} |")
    return "\n".join(lines)
