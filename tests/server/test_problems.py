"""One line for each thing that is wrong: the key, why, and what was given."""

from typing import Annotated, Any

import pytest
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from voltcam_server.problems import explain, faults, one_line, where


class Inner(BaseModel):
    model_config = ConfigDict(extra="forbid")

    size: int = Field(1, gt=0)
    address: Annotated[str, Field(pattern=r"^\w+:\d+$", examples=["here:80"])] = "here:80"


class Outer(BaseModel):
    model_config = ConfigDict(extra="forbid")

    inner: Inner = Inner()
    named: dict[str, Inner] = {}
    on: bool = False


def complaint(given: Any) -> str:
    with pytest.raises(ValidationError) as caught:
        Outer.model_validate(given)
    return explain(caught.value, Outer)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"inner": {"size": "many"}}, "inner.size: give a whole number, not 'many'"),
        ({"inner": {"size": 0}}, "inner.size: Input should be greater than 0, not 0"),
        ({"inner": {"adress": "x"}}, "inner.adress: there is no such key, only size, address"),
        ({"inner": {"address": "x"}}, "inner.address: give it like here:80, not 'x'"),
        ({"named": {"left": {"sise": 1}}}, "named.left.sise: there is no such key, only size, address"),
        ({"inner": 5}, "inner: it has several parts: give inner.NAME=VALUE, not 5"),
        ({"on": "perhaps"}, "on: give true or false, not 'perhaps'"),
    ],
)
def test_a_fault_names_its_key_and_the_remedy(given: Any, words: str) -> None:
    assert complaint(given) == words


def test_all_faults_are_told_and_what_was_given_is_cut() -> None:
    said = complaint({"on": "x" * 10_000, "inner": {"size": -1}})
    assert said.count(";") == 1
    assert len(said) < 300
    with pytest.raises(ValidationError) as caught:
        Outer.model_validate({"on": 7, "inner": {"size": -1}})
    assert [path for path, _ in faults(caught.value, Outer)] == [("inner", "size"), ("on",)]


def test_where_an_error_comes_from_is_one_line() -> None:
    assert one_line("a\n  b\tc") == "a b c"
    try:
        raise RuntimeError("a\nbug")
    except RuntimeError as error:
        said = where(error)
    assert said.startswith("RuntimeError(")
    assert "test_problems.py, line " in said
    assert "\n" not in said
