"""One look for all figures, and their way to a file or into a page. Only the object API of matplotlib."""

import base64
import io
from collections.abc import Callable, Sequence
from functools import wraps
from pathlib import Path
from typing import Any, Literal, ParamSpec

import matplotlib as mpl
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from PIL import Image

P = ParamSpec("P")

# Okabe and Ito's colours, told apart by every kind of colour vision; ON and OFF as on the daemon's page.
BLACK, ORANGE, SKY, GREEN = "#000000", "#e69f00", "#56b4e9", "#009e73"
BLUE, VERMILION, PURPLE, WINE = "#0072b2", "#d55e00", "#cc79a7", "#882255"
OLIVE = "#999933"  # this and wine: Paul Tol's, of the same kind
ON, OFF, REAL = BLUE, VERMILION, "#3a3f45"
ON_OFF = LinearSegmentedColormap.from_list("on_off", [VERMILION, "#f6c7a6", "#ffffff", "#a3cbe6", BLUE])
_MODELS = {
    "exact": BLUE, "paper": PURPLE, "esim": GREEN, "v2e": ORANGE, "no noise": SKY,
    "exact, by likelihood alone": OLIVE, "paper, thresholds fitted": VERMILION, "paper, as published": WINE,
}  # fmt: skip
_OTHERS = (SKY, VERMILION, WINE, BLACK, OLIVE, GREEN, ORANGE, PURPLE, BLUE)

STYLE: Any = {  # rc_context wants every name as a literal
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 9,
    "axes.labelcolor": "#3a3f45",
    "axes.edgecolor": "#9aa2ac",
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "grid.color": "#e3e6ea",
    "grid.linewidth": 0.7,
    "xtick.color": "#5a6472",
    "ytick.color": "#5a6472",
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "lines.linewidth": 1.6,
    "figure.facecolor": "white",
    "figure.constrained_layout.h_pad": 0.08,  # inches: by less, titles at the top lose a pixel
    "savefig.dpi": 110,
    "svg.fonttype": "none",  # text stays text: smaller, and can be searched
    "svg.hashsalt": "voltcam",  # the same figure gives the same file
}


def styled(draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """A function that draws a figure, in this style."""

    @wraps(draw)
    def drawn(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with mpl.rc_context(STYLE):
            return draw(*args, **kwargs)

    return drawn


def colours(names: Sequence[str]) -> dict[str, str]:
    """A colour for each model, no two alike among nine. What precedes a comma has its own in every figure; a
    second model of that kind has one of its own if it is known, or one that is left."""
    found = {name: _MODELS[name] for name in names if name in _MODELS}
    for name in names:
        kind = _MODELS.get(name.split(",")[0])
        left = [one for one in _OTHERS if one not in found.values()] or _OTHERS
        if name not in found:
            found[name] = kind if kind and kind not in found.values() else left[0]
    return {name: found[name] for name in names}


def save(figure: Figure, path: Path) -> None:
    """As PNG or SVG, by the suffix; the same figure gives the same bytes."""
    path.write_bytes(_bytes(figure, "svg" if path.suffix == ".svg" else "png"))


def as_uri(figure: Figure, kind: Literal["svg", "png"] = "svg") -> str:
    """A `data:` address that an <img> of a self-contained page can have; PNG where there are many points."""
    mime = {"svg": "image/svg+xml", "png": "image/png"}[kind]
    return f"data:{mime};base64,{base64.b64encode(_bytes(figure, kind)).decode('ascii')}"


def _bytes(figure: Figure, kind: Literal["svg", "png"]) -> bytes:
    target = io.BytesIO()
    with mpl.rc_context(STYLE):
        figure.savefig(target, format=kind, metadata={"Date": None} if kind == "svg" else {"Software": None})
    return target.getvalue() if kind == "svg" else _smaller(target)


def _smaller(png: io.BytesIO) -> bytes:
    """The same with a palette: a third of the size."""
    target = io.BytesIO()
    with Image.open(png) as image:
        image.convert("RGB").quantize(96, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).save(
            target, "png", optimize=True
        )
    return target.getvalue()
