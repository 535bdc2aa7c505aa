"""report.html of `voltcam calibrate`: what was found, how it was told, and how well the camera then fits."""

from pathlib import Path

import numpy as np
from markupsafe import Markup

from voltcam_simulator.effect import Events

from ..distances import FrameLight, Region
from ..distances.counts import count_images, watched
from ..distances.inter_event_intervals import IntervalStrata, same_polarity
from ..health import Health
from ..models.model import MODELS, simulate
from ..pages.histograms import interval_histograms
from ..pages.page import figure, render, table, write
from ..pages.residuals import residual_maps
from .calibrated import Calibrated
from .estimates import Estimate
from .figures import parameter_intervals

WORDS = {"good": "good", "limits": "warn", "fatal": "bad"}


def write_report(found: Calibrated, source: str, folder: Path, seed: int) -> Path:
    """Write folder/report.html. source: name of the recording. Returns the page's path."""
    page = render(
        "report.html",
        title=f"Camera calibrated from {source}",
        subtitle="; ".join(found.notes[:1]),
        body=[_verdict(found), *_parameters(found), *_held_against(found, seed), *_health(found.health)],
    )
    path = folder / "report.html"
    write(path, page)
    return path


def _verdict(found: Calibrated) -> Markup:
    fixed = sum(one.determined for one in found.estimates)
    kind = "good" if found.health.usable and (fixed > 0 or not found.estimates) else "warn"
    said = (
        f"{fixed} of {len(found.estimates)} parameters are fixed by this recording. "
        if found.estimates
        else ""
    )
    lines = Markup("").join(Markup("<li>{}</li>").format(note) for note in found.notes[1:])
    return Markup('<p class="verdict {}">{}{}</p><ul>{}</ul>').format(
        kind, said, found.health.text().splitlines()[0], lines
    )


def _parameters(found: Calibrated) -> list[Markup]:
    if not found.estimates:
        return []
    rows = [_row(one) for one in found.estimates]
    return [
        Markup("<h2>Parameters</h2>"),
        figure(
            parameter_intervals(found.estimates),
            "Each parameter with its 90 % interval, blue where the recording fixes it, grey where not; the "
            "band is what is usual, the prior's 90 %.",
        ),
        table(["effect", "parameter", "likeliest", "90 % from", "to", "rests on"], rows),
        *_refined(found),
    ]


def _refined(found: Calibrated) -> list[Markup]:
    if not found.moved:
        return []
    told = (
        "What the likelihood of single intervals cannot tell: these were then moved until simulated events "
        "were most like the recorded ones. The camera file has them so; they are no better known by that."
    )
    return [
        Markup("<h2>Moved to behave as the recording</h2><p>{}</p>").format(told),
        table(["parameter", "likeliest", "in the camera file"], [list(each) for each in found.moved]),
    ]


def _row(one: Estimate) -> list[object]:
    return [one.effect, one.parameter, one.value, one.low, one.high, one.rests_on]


def _held_against(found: Calibrated, seed: int) -> list[Markup]:
    """The recording beside what the calibrated camera makes of its frames; not held out, so that it shows
    misfit."""
    reading, scene = found.reading, found.reading.scene
    made = simulate(MODELS[found.method](scene.width, scene.height, found.camera.parameters, seed), scene)
    begin, end = int(scene.t_us[0]), int(scene.t_us[-1])
    region = Region.whole(scene.width, scene.height, begin, end).on(reading.keep)
    real, simulated = (_unmasked(events, found) for events in (reading.events, made))
    intervals = {name: same_polarity(events, region) for name, events in (("real", real), ("sim", simulated))}
    frames = np.clip(np.rint(scene.taken), 0, 255).astype(np.uint8)
    strata = IntervalStrata.of(intervals["real"], FrameLight(frames, scene.taken_us))
    name = f"{found.method}, calibrated"
    counts = [[int(np.count_nonzero(e["p"] == on)) for on in (True, False)] for e in (real, simulated)]
    return [
        Markup("<h2>Measured and simulated</h2>"),
        table(["", "ON events", "OFF events"], [["recording", *counts[0]], [name, *counts[1]]]),
        figure(
            interval_histograms(intervals["real"], {name: intervals["sim"]}, strata),
            "Time between two events of a pixel and polarity, by thirds of brightness and change (the "
            "paper's Fig. 4): the recording in grey, the calibrated camera as a line.",
        ),
        figure(
            residual_maps(
                count_images(real, region), {name: count_images(simulated, region)}, watched(region)
            ),
            "Where and when the calibrated camera has more events than the recording (blue), or fewer (red).",
            "png",
        ),
    ]


def _unmasked(events: Events, found: Calibrated) -> Events:
    """Less those at times that were left out, row by row."""
    t_us = events["t"].astype(np.float64)
    kept: Events = events[found.mask.start(t_us, events["y"].astype(np.int64)) == t_us]
    return kept


def _health(health: Health) -> list[Markup]:
    cell = Markup('<b class="{}">{}</b>')
    rows = [[one.name, cell.format(WORDS[one.severity], one.severity), one.words] for one in health.findings]
    answers = [[", ".join(one.parameters), one.answer, one.words] for one in health.determinations]
    return [
        Markup("<h2>Health of the recording</h2>"),
        _wrapped(table(["", "", "what was seen"], rows)),
        Markup("<h2>What it can determine</h2>"),
        _wrapped(table(["parameters", "", "why"], answers)),
    ]


def _wrapped(made: Markup) -> Markup:
    """Of long sentences, which would run out of the page."""
    return made.replace(Markup("<td>"), Markup('<td style="white-space: normal">'))
