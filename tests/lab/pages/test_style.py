"""One look for all figures, and their way to files and pages."""

import base64
import io
from pathlib import Path

import matplotlib as mpl
import pytest
from matplotlib.figure import Figure
from PIL import Image

from voltcam_lab.pages.style import as_uri, colours, save, styled


def test_a_figure_goes_into_a_page() -> None:
    figure = Figure((1, 1))
    assert as_uri(figure).startswith("data:image/svg+xml;base64,")
    assert as_uri(figure, "png").startswith("data:image/png;base64,")


@styled
def drawn(height: float = 1.0) -> Figure:
    figure = Figure((2, 1))
    figure.subplots().plot([0, 1, 2], [0, height, 0], "o-", label="a curve")
    return figure


@pytest.mark.parametrize(("suffix", "begins"), [(".svg", b"<?xml"), (".png", b"\x89PNG")])
def test_a_figure_is_the_same_each_time(tmp_path: Path, suffix: str, begins: bytes) -> None:
    written = []
    for height in (1.0, 1.0, 2.0):
        save(drawn(height), tmp_path / f"curve{suffix}")
        written.append((tmp_path / f"curve{suffix}").read_bytes())
    assert written[0] == written[1] != written[2]
    assert written[0].startswith(begins)


def test_what_a_page_has_in_it_is_the_file(tmp_path: Path) -> None:
    save(drawn(), tmp_path / "curve.svg")
    kind, content = as_uri(drawn()).split(",")
    assert kind == "data:image/svg+xml;base64"
    assert base64.b64decode(content) == (tmp_path / "curve.svg").read_bytes()


def test_a_png_keeps_its_size_and_has_a_palette() -> None:
    with Image.open(io.BytesIO(base64.b64decode(as_uri(drawn(), "png").split(",")[1]))) as image:
        assert image.mode == "P"
        assert image.size == (220, 110)  # 2 x 1 inches of 110 dots


def test_the_style_is_on_while_drawing_and_gone_afterwards() -> None:
    before = dict(mpl.rcParams)
    (axes,) = drawn().get_axes()
    assert not axes.spines["top"].get_visible()
    assert dict(mpl.rcParams) == before


def test_a_model_has_its_colour_in_every_figure() -> None:
    few, many = colours(["exact", "v2e"]), colours(["v2e", "mine", "exact", "yours"])
    assert all(many[name] == colour for name, colour in few.items())
    assert colours(["exact, calibrated"])["exact, calibrated"] == few["exact"]


def test_no_two_models_share_a_colour() -> None:
    evaluated = [
        "exact, calibrated", "exact, by likelihood alone", "paper, calibrated", "paper, thresholds fitted",
        "esim, thresholds fitted", "v2e, thresholds fitted", "paper, as published",
        "no noise, thresholds fitted",
    ]  # fmt: skip
    for names in (evaluated, evaluated[::-1], ["exact", "exact, calibrated", "mine", "yours"]):
        found = colours(names)
        assert list(found) == names
        assert len(set(found.values())) == len(names)


def test_more_models_than_colours_have_one_each() -> None:
    assert len(colours([f"mine {n}" for n in range(12)])) == 12
