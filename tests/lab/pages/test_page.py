"""Pages of reports: self-contained, escaped, written whole."""

from html.parser import HTMLParser
from pathlib import Path

import pytest
from jinja2 import UndefinedError
from matplotlib.figure import Figure

from voltcam_lab.pages import page


class Links(HTMLParser):
    """All addresses that a page would load, and its tags."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.addresses: list[str] = []
        self.tags: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.addresses += [value or "" for name, value in attributes if name in ("src", "href")]


def drawn() -> Figure:
    figure = Figure((1, 1))
    figure.subplots().plot([0, 1], [1, 0])
    return figure


def test_a_page_has_its_figures_in_itself_and_loads_nothing() -> None:
    html = page.render("report.html", title="A camera", body=[page.figure(drawn(), "Falls & falls")])
    links = Links(html)
    assert links.addresses
    assert all(address.startswith("data:") for address in links.addresses)
    assert "script" not in links.tags
    assert "Falls &amp; falls" in html
    assert "prefers-color-scheme: dark" in html


def test_text_is_escaped() -> None:
    html = page.render("report.html", title="<b>camera</b>", subtitle="a & b", body=["<script>x</script>"])
    assert "<b>camera</b>" not in html
    assert "&lt;script&gt;" in html
    assert "a &amp; b" in html


def test_what_a_template_lacks_is_an_error() -> None:
    with pytest.raises(UndefinedError):
        page.render("report.html", title="A camera")


def test_a_table_shows_numbers_to_three_digits_and_unknown_ones_as_a_dash() -> None:
    html = page.table(["name", "value"], [["k1 <", 5.26512], ["k2", float("nan")], ["n", 12345]])
    assert ">5.27<" in html
    assert ">–<" in html
    assert ">12345<" in html
    assert "k1 &lt;" in html


def test_a_page_is_written_whole(tmp_path: Path) -> None:
    path = tmp_path / "new" / "report.html"
    page.write(path, "<p>µ</p>")
    page.write(path, "<p>again µ</p>")
    assert path.read_text(encoding="utf-8") == "<p>again µ</p>"
    assert [entry.name for entry in path.parent.iterdir()] == ["report.html"]
