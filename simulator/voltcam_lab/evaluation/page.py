"""docs/how-it-works/evaluation.md with its figures: written anew from evaluations, by `voltcam evaluate`."""

import re
from collections.abc import Callable, Sequence
from pathlib import Path

from voltcam_simulator import Parameters

from ..distances import HEADLINES, MEASURES, noise_rates
from ..distances.counts import count_images, watched
from ..distances.inter_event_intervals import IntervalStrata, same_polarity
from ..models.model import MODELS
from ..pages.clouds import busiest, clouds
from ..pages.histograms import interval_histograms
from ..pages.residuals import residual_maps
from ..pages.style import save
from .bars import held_to
from .evaluate import Evaluation
from .figures.dots import dots
from .figures.noise import HeldImage, noise_against_intensity, noise_in_recording
from .figures.temperature import LeakByTemperature, leak_by_temperature, temperature

MOST_IN_FIGURE = 5
"""Models a figure has room for: the first ones."""

INTRODUCTION = """# Evaluation

Written by `voltcam evaluate`; do not edit. Every model is shown the same light (the recording's frames, with
more between them), and what it gives out is held against what the camera gave out.

{measures}

In the first table of a recording, fitting and judging share neither a pixel nor a time. Tiles of 24 x 24
pixels, crossed with blocks of 400 ms, are judged that had no part in any fit. Of a recording with few events
these are all four quarters, each by the fit on the quarter opposite. The light between frames, the same for
all models, is part of the fit of the exact law. Windows around the exposures of frames, in which the camera's
own readout makes events, are cut out of both streams, and hot pixels left out.

The tables "first part against later part" are of a camera that `voltcam calibrate` has made of the first 60 %
of the time, or more of a short recording. It is judged on the rest, once with windows cut out. The second
time all events count, as a user of the emulator sees them.

The last table tells how far behind the frames events are, as the health report measures it. Windows about
exposures count there.

The last two rows of a table are real events against real events of the same recording: other pixels (a
checkerboard) and other times (every other 100 ms). No simulation can be expected to come closer than that.
"""

BARS = """What was asked: half the distance of the best published simulator to the floor, b4 above .93. The
published ones (DVS-Voltmeter's own code, ESIM, v2e) had their thresholds fitted to the totals of what they
were judged by; ours saw nothing of it. Floors grow with fewer events judged: "its floor here" is this part's.
"""


def write_evaluation(
    evaluations: Sequence[Evaluation],
    out: Path,
    notes: Sequence[str] = (),
    progress: Callable[[str], None] = lambda _: None,
) -> Path:
    """Write out/evaluation.md and its figures, out/evaluation/*.png. Returns the page's path."""
    folder = out / "evaluation"
    folder.mkdir(parents=True, exist_ok=True)
    measures = "\n".join(f"- **{m.name}**: {m.title} [{m.unit}]{_best(m.best)}." for m in MEASURES.values())
    parts = [INTRODUCTION.format(measures=measures)]
    for evaluation in evaluations:
        progress(f"figures of {evaluation.name}")
        parts.append(_of_recording(evaluation, folder))
    if notes:
        parts.append(
            "## How models were fitted, and what could not be\n\n"
            + "\n".join(f"- {note}." for note in notes)
            + "\n"
        )
    progress("held images")
    parts.append(_of_models(folder))
    page = out / "evaluation.md"
    page.write_text("\n".join(parts), encoding="utf-8")
    return page


def _best(best: float | None) -> str:
    return "" if best is None else f"; {best:g} is best"


def _of_recording(evaluation: Evaluation, folder: Path) -> str:
    slug = re.sub(r"[^a-z0-9]+", "-", evaluation.name.lower()).strip("-") or "recording"
    yardstick = evaluation.yardstick
    region, real = yardstick.region, yardstick.real
    width, height = evaluation.recording.width, evaluation.recording.height
    shown = dict(list(evaluation.simulated.items())[:MOST_IN_FIGURE])
    streams = {"real": real, **shown}
    intervals = {name: same_polarity(events, region) for name, events in streams.items()}
    models = {name: intervals[name] for name in shown}
    judged = {name: region.of(events) for name, events in streams.items()}
    window = busiest(judged["real"], width, height)
    strata = IntervalStrata.of(intervals["real"], yardstick.light)
    figures = {
        "distances": (
            dots(evaluation.rows, evaluation.floors),
            f"How far each model is from real events, by {', '.join(HEADLINES)}. Left is better.",
        ),
        "clouds": (
            clouds(judged, intervals, window),
            "The paper's Fig. 5, of events that are judged. Top: the busiest 64 x 64 pixels. Middle: their "
            "time surface at its fullest, decay 3.0 ms. Bottom: density of the intervals between events of a "
            "pixel and polarity, real in grey.",
        ),
        "intervals": (
            interval_histograms(intervals["real"], models, strata),
            "The paper's Fig. 4: the same intervals by terciles of brightness and of change.",
        ),
        "residuals": (
            residual_maps(
                count_images(real, region),
                {name: count_images(events, region) for name, events in shown.items()},
                watched(region),
            ),
            "Events simulated for each real one: over the sensor (grey: not judged), and over time.",
        ),
        "noise": (
            noise_in_recording(
                yardstick.noise(),
                {name: noise_rates(events, region, yardstick.light) for name, events in shown.items()},
            ),
            "Events at pixels whose light stands still.",
        ),
    }
    lines = [f"## {evaluation.name}\n", _facts(evaluation), "", evaluation.to_markdown(), ""]
    for title, other in evaluation.protocols.items():
        lines += [f"### {evaluation.name}: {title}\n", _facts(other), "", other.to_markdown(), ""]
    bars = held_to(evaluation.name, evaluation.rows, next(iter(evaluation.floors.values())))
    lines += [BARS, bars, ""] if bars else []
    for kind, (figure, caption) in figures.items():
        save(figure, folder / f"{slug}-{kind}.png")
        lines.append(f"![{caption}]({folder.name}/{slug}-{kind}.png)\n\n{caption}\n")
    return "\n".join(lines)


def _facts(evaluation: Evaluation) -> str:
    recording, region = evaluation.recording, evaluation.yardstick.region
    frames = evaluation.yardstick.light.t_us
    judged = region.of(evaluation.yardstick.real).size
    return (
        f"{recording.width} x {recording.height} pixels, {len(frames)} frames in "
        f"{(frames[-1] - frames[0]) / 1e6:.2f} s, {recording.events.size} events; judged by {judged} of "
        f"these, in {region.pixel_seconds:.0f} pixel seconds."
    )


def _of_models(folder: Path) -> str:
    held, published = HeldImage(), Parameters.of("paper")
    noisy = published.changed({"photon_noise": {"k3": 3e-3}, "leak_noise": {"k6": 3e-4}})
    panels = {
        title: (
            parameters,
            {
                law: held.rates(MODELS[law](held.intensities, held.rows, parameters, 1))
                for law in ("exact", "paper")
            },
        )
        for title, parameters in (
            ("DAVIS346 as published", published),
            ("30 times its noise (k3, k6)", noisy),
        )
    }
    save(noise_against_intensity(held, panels), folder / "noise.png")
    set_up = LeakByTemperature()
    dark = published.changed({"parasitic_photocurrent": {"k5_per_dn_us": 0}})
    leaks = {
        title: (parameters, leak_by_temperature(set_up, parameters))
        for title, parameters in (("published, at 128 DN", published), ("the same without k5", dark))
    }
    save(temperature(set_up, leaks), folder / "temperature.png")
    return f"""## Noise by intensity, leak by temperature

![Noise events by intensity, exact and paper law beside the closed form]({folder.name}/noise.png)

The paper's Fig. 6: a ramp of intensities, held for {held.seconds:g} s at {held.fps:g} fps. Lines are the
rates at which Brownian motion with the drift and noise of Eq. 10 and 11 leaves its band; the exact law is on
them, the paper law depends on the frame rate.

![Leak rate against temperature, on Arrhenius' axes]({folder.name}/temperature.png)

ON events of a held image by temperature. The junction leak follows Arrhenius' law, a straight line here; the
parasitic photocurrent does not depend on temperature and takes over in the cold.
"""
