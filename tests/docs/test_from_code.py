"""What the reference says because the code says it."""

import re
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "docs"))
import from_code
from from_code import parameters, rest
from from_code.markdown import sentence, table
from tests.docs.blocks import DOCS

from voltcam_client.formats import READABLE
from voltcam_server.settings import Settings
from voltcam_simulator import Parameters, camera_names
from voltcam_simulator.effects import EFFECTS


def rows(text: str) -> list[list[str]]:
    """The cells of all lines of tables."""
    lines = (line for line in text.splitlines() if line.startswith("| "))
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines]


def test_every_chapter_stands_on_a_page_and_every_page_asks_for_one_there_is() -> None:
    asked = [name for page in DOCS.rglob("*.md") for name in from_code.MARK.findall(page.read_text())]
    assert sorted(asked) == sorted(from_code.CHAPTERS)


def test_a_page_that_asks_for_what_there_is_not_is_refused() -> None:
    with pytest.raises(KeyError):
        from_code.filled("<!-- from the code: nothing -->")


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.name)
def test_each_parameter_has_unit_limits_default_meaning_and_source(effect: type) -> None:
    chapter = parameters.chapter()
    section = re.split(r"^##+ ", chapter.partition(f"### `{effect.name}`\n")[2], flags=re.MULTILINE)[0]
    told = {row[0]: row[1:] for row in rows(section)}
    for name, field in effect.model_fields.items():
        unit, limits, default, meaning, source = told[f"`{name}`"]
        assert limits
        assert meaning
        if isinstance(field.json_schema_extra, dict):
            assert unit == field.json_schema_extra["unit"]
            assert source
            assert float(default) == field.default


def test_limits() -> None:
    fields = Parameters.model_fields["comparator"].annotation.model_fields
    assert parameters.limits(fields["theta_on"]) == "0.001 to 100"
    fields = Parameters.model_fields["flicker"].annotation.model_fields
    assert parameters.limits(fields["frequency_hz"]) == "above 0, to 10000"


def test_presets_differ_where_they_are_bold() -> None:
    head, _, *told = rows(parameters.presets())
    assert [cell.strip("`") for cell in head[2:]] == camera_names()
    for key, default, *values in told:
        effect, _, name = key.strip("`").partition(".")
        for camera, value in zip(camera_names(), values, strict=True):
            own = getattr(Parameters.of(camera), effect)
            own = getattr(own, name) if name else own
            written = default if value == "·" else value.strip("*")
            assert written == own if isinstance(own, str) else float(written) == pytest.approx(own)


def test_every_request_of_the_openapi_document_has_a_section_with_its_statuses() -> None:
    chapter = rest.chapter()
    for path, ways in rest.document()["paths"].items():
        for way, each in ways.items():
            section = chapter.partition(f"### `{way.upper()} {path}`\n")[2].partition("\n##")[0]
            assert each["description"].split("\n")[0] in section.replace("\\", "")
            for status in each["responses"]:
                assert re.search(rf"\b{status}\b", section)


def test_every_setting_is_told() -> None:
    chapter = from_code.CHAPTERS["settings"]()
    told = {row[0].strip("`") for row in rows(chapter)}
    assert set(Settings.model_fields) <= told


def test_every_suffix_is_told() -> None:
    assert {row[0].strip("`") for row in rows(from_code.CHAPTERS["formats"]())[2:]} == set(READABLE)


def test_a_table_holds_what_would_break_it() -> None:
    assert table(("a", "b"), [("x | y", "two\nlines")]).splitlines()[2] == r"| x \| y | two lines |"


def test_a_sentence_begins_with_a_capital_unless_it_is_a_name() -> None:
    assert sentence("the first") == "The first."
    assert sentence("parameters_version: that of the packets.") == "parameters_version: that of the packets."
