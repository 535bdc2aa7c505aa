"""The page."""

import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from voltcam_lab.diagnosis.outcome.conclude import result_of
from voltcam_lab.diagnosis.outcome.report import page_of
from voltcam_lab.diagnosis.outcome.where import views
from voltcam_lab.diagnosis.search import loop

from ..conftest import Done

FIGURES = 9


class Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.loaded: list[str] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.loaded += [value or "" for name, value in attrs if name in ("src", "href")]

    def handle_data(self, data: str) -> None:
        self.text += data


def read(page: str) -> Reader:
    reader = Reader()
    reader.feed(page)
    reader.text = re.sub(r"\s+", " ", reader.text)
    return reader


@pytest.fixture(scope="module")
def page(done: Done) -> Reader:
    result = result_of(done.session, done.search, done.identifiability, done.diagnosis)
    return read(page_of(done.session, done.search, done.identifiability, done.diagnosis, result))


def test_the_page_says_the_verdict_and_shows_each_figure(done: Done, page: Reader) -> None:
    result = result_of(done.session, done.search, done.identifiability, done.diagnosis)
    assert "Missing: refractory period" in page.text
    assert result.sentence in page.text
    assert page.tags.count("img") == FIGURES
    for title in ("Rates by brightness", "Intervals", "Response in time", "Pixels", "Spectrum", "row scan"):
        assert title in page.text
    for one in done.identifiability.base:
        assert f"{one.effect}.{one.name}" in page.text


def test_the_page_needs_nothing_beside_it(page: Reader) -> None:
    assert "script" not in page.tags
    assert all(address.startswith(("data:image/svg", "#")) for address in page.loaded)


def test_a_diagnosis_that_found_nothing_has_a_page_and_names_from_outside_are_escaped(done: Done) -> None:
    session, first = replace(done.session, name="<b>walk</b>"), done.diagnosis.steps[0]
    nothing = loop.Diagnosis("unknown", (), first.hypothesis, (first,))
    assert list(views(done.search, nothing)) == ["model"]
    result = result_of(session, done.search, done.identifiability, nothing)
    assert not result.effects
    assert result.gap.before == result.gap.after
    page = page_of(session, done.search, done.identifiability, nothing, result)
    assert "Something unknown is missing" in read(page).text
    assert "<b>walk</b>" not in page
