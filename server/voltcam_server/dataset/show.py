"""A page of a set: what is in it, how it varies, and what someone should look at."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup
from matplotlib.figure import Figure

from voltcam_client.meter import short
from voltcam_lab.pages.page import figure, render, table, write
from voltcam_lab.pages.style import BLUE, VERMILION, as_uri, styled

from ..problems import UsageError
from .manifest import Record, read_manifest
from .outliers import Outlier, outliers, pixel_rate
from .pictures import drawn_picture, picture_of
from .space import in_words

SAMPLES, MOST_OUTLIERS, MOST_FAILED = 8, 12, 100


def show_set(folder: Path, page: Path) -> Path:
    """Write the page. Raises UsageError where there is no set, or nothing in it."""
    records = read_manifest(folder)
    made = [record for record in records if "failed" not in record]
    if not made:
        raise UsageError(f"{folder} has no item: see its manifest.jsonl for the reasons")
    failed = [record for record in records if "failed" in record]
    strange = outliers(made)
    body = [
        *_summary(folder, made, failed),
        *_failures(failed),
        *_strange(folder, strange),
        Markup("<h2>Samples</h2>"),
        _pictures(folder, _spread_out(made), [""] * SAMPLES),
        *_rates(made, strange),
        *_parameters(made),
    ]
    write(page, render("report.html", title=f"Data set {folder.absolute().name}", subtitle="", body=body))
    return page


def _summary(folder: Path, made: Sequence[Record], failed: Sequence[Record]) -> list[Markup]:
    events, seconds = (sum(record[key] for record in made) for key in ("events", "seconds"))
    rate = float(np.median([record["events_per_s"] for record in made]))
    sizes = Counter(f"{record['camera']} {record['width']}x{record['height']}" for record in made)
    rows = [
        ("items", f"{len(made)}, of {len({record['name'] for record in made})} inputs"),
        ("without an item", str(len(failed))),
        ("cameras", ", ".join(f"{name}: {count}" for name, count in sizes.most_common())),
        ("time", f"{seconds:.1f} s, {sum(record['frames'] for record in made)} frames"),
        ("events", f"{short(events)}, median {short(rate)}/s an item"),
        ("ON", f"{sum(record['on'] for record in made) / max(events, 1):.1%} of the events"),
        ("on the disk", in_words(sum(record["bytes"] for record in made))),
        ("made with", ", ".join(_software(made))),
    ]
    return [table(["", f"manifest.jsonl of {folder.absolute().name}"], rows)]


def _software(made: Sequence[Record]) -> list[str]:
    """Each name with all the versions that items were made with."""
    names = list(dict.fromkeys(name for record in made for name in record["software"]))
    return [
        f"{name} {' and '.join(sorted({record['software'].get(name, 'none') for record in made}))}"
        for name in names
    ]


def _failures(failed: Sequence[Record]) -> list[Markup]:
    if not failed:
        return []
    reasons = Counter((record["name"], record["failed"]) for record in failed)
    rows = [
        (name, why if count == 1 else f"{why} ({count} variants)")
        for (name, why), count in list(reasons.items())[:MOST_FAILED]
    ]
    more = [f"and {len(reasons) - MOST_FAILED} more, in manifest.jsonl"] if len(reasons) > MOST_FAILED else []
    return [Markup("<h2>Without an item</h2>"), table(["input", "why"], rows), *map(_paragraph, more)]


def _strange(folder: Path, strange: Sequence[Outlier]) -> list[Markup]:
    if not strange:
        return [_paragraph("No item stands out from the others.")]
    shown = strange[:MOST_OUTLIERS]
    more = len(strange) - len(shown)
    words = f"{len(strange)} of the items stand out" + (f"; the first {len(shown)}:" if more else ":")
    pictures = _pictures(folder, [one.record for one in shown], [one.why for one in shown])
    return [Markup("<h2>To look at</h2>"), _paragraph(words), pictures]


def _pictures(folder: Path, records: Sequence[Record], words: Sequence[str]) -> Markup:
    """Frame and events of each."""
    cells = []
    for record, why in zip(records, words, strict=False):
        picture = picture_of(folder, record)
        image = Markup("<p>it cannot be read: <code>voltcam dataset check</code></p>")
        if picture is not None:
            image = Markup('<img src="{}" alt="">').format(as_uri(drawn_picture(picture), "png"))
        span = f", events of {picture.span_us / 1000:.3g} ms" if picture is not None else ""
        label = f"{record['name']}, variant {record['variant']}"
        cells.append(
            Markup('<figure class="item">{}<figcaption><b>{}</b>{}{}</figcaption></figure>').format(
                image, label, span, f": {why}" if why else ""
            )
        )
    return Markup('<div class="items">{}</div>').format(Markup("").join(cells))


def _spread_out(made: Sequence[Record]) -> list[Record]:
    """By rate, from the calmest to the busiest."""
    ordered = sorted(made, key=pixel_rate)
    places = np.unique(np.linspace(0, len(ordered) - 1, min(SAMPLES, len(ordered))).round().astype(int))
    return [ordered[place] for place in places]


def _rates(made: Sequence[Record], strange: Sequence[Outlier]) -> list[Markup]:
    caption = "Events a second and pixel of each item, in order; red: those that stand out."
    return [Markup("<h2>Event rates</h2>"), figure(_rate_figure(made, strange), caption)]


@styled
def _rate_figure(made: Sequence[Record], strange: Sequence[Outlier]) -> Figure:
    odd = {(one.record["name"], one.record["variant"]) for one in strange}
    ordered = sorted(made, key=pixel_rate)
    rates = np.array([pixel_rate(record) for record in ordered])
    far = np.array([(record["name"], record["variant"]) in odd for record in ordered])
    drawn = Figure((8.8, 2.6), layout="constrained")
    curve, bars = drawn.subplots(1, 2, width_ratios=[2, 1])
    places = np.arange(len(rates))
    curve.plot(places, rates, ".", color=BLUE, markersize=4)
    curve.plot(places[far], rates[far], ".", color=VERMILION, markersize=6)
    curve.set_xlabel("items, by rate")
    curve.set_ylabel("events / (s pixel)")
    if rates.min() > 0 and rates.max() > 10 * rates.min():
        curve.set_yscale("log")
    curve.grid(True)
    bars.hist(rates, bins=min(40, max(5, len(rates) // 5)), color=BLUE)
    bars.set_xlabel("events / (s pixel)")
    bars.set_ylabel("items")
    return drawn


def _parameters(made: Sequence[Record]) -> list[Markup]:
    names = sorted({name for record in made for name in record["drawn"]})
    if not names:
        return [Markup("<h2>Parameters</h2>"), _paragraph("All items have the same: nothing was drawn.")]
    caption = "What was drawn, and how many items have it. Below, the rate of each item by it."
    return [Markup("<h2>Drawn parameters</h2>"), *(
        figure(_parameter_figure(made, names[at : at + 4]), caption if at == 0 else "")
        for at in range(0, len(names), 4)
    )]  # fmt: skip


@styled
def _parameter_figure(made: Sequence[Record], names: Sequence[str]) -> Figure:
    drawn = Figure((2.2 * 4, 3.4), layout="constrained")
    axes = drawn.subplots(2, 4, squeeze=False, sharex="col")
    for column in range(4):
        counts, rates = axes[0, column], axes[1, column]
        if column >= len(names):
            counts.set_axis_off()
            rates.set_axis_off()
            continue
        name = names[column]
        having = [record for record in made if name in record["drawn"]]
        values: list[Any] = [record["drawn"][name] for record in having]
        counts.set_title(name.replace(".", "\n"), fontsize=8)
        if all(isinstance(value, int | float) for value in values):
            _numbers(counts, rates, np.array(values, float), having)
        else:
            words = [str(value) for value in values]
            counts.bar(*zip(*sorted(Counter(words).items()), strict=True), color=BLUE)
            rates.plot(words, [pixel_rate(record) for record in having], ".", color=BLUE, markersize=3)
        rates.grid(True)
    axes[0, 0].set_ylabel("items")
    axes[1, 0].set_ylabel("events / (s pixel)")
    return drawn


def _numbers(counts: Any, rates: Any, values: Any, having: Sequence[Record]) -> None:
    if values.min() > 0 and values.max() > 20 * values.min():
        rates.set_xscale("log")
        edges = np.geomspace(values.min(), values.max(), 13)
    else:
        edges = np.linspace(values.min(), values.max() + 1e-12, 13)
    counts.hist(values, bins=edges, color=BLUE)
    rates.plot(values, [pixel_rate(record) for record in having], ".", color=BLUE, markersize=3)


def _paragraph(text: str) -> Markup:
    return Markup("<p>{}</p>").format(text)
