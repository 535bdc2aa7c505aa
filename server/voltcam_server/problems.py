"""What a person is told about input that is wrong: one line that names the key and the remedy."""

import reprlib
import traceback
from collections.abc import Iterator, Sequence
from typing import Any, get_args, get_origin

from pydantic import BaseModel, ValidationError

SHOWN = 60  # characters of a wrong value
# What a person can do, where the validator's own words are about types.
WORDS = {
    "int_parsing": "give a whole number",
    "int_type": "give a whole number",
    "int_from_float": "give a whole number",
    "float_parsing": "give a number",
    "float_type": "give a number",
    "model_type": "it has several parts: give {key}.NAME=VALUE",
    "bool_parsing": "give true or false",
}


class UsageError(ValueError):
    """One line for the user: what is wrong, and the remedy."""


KeyPath = tuple[str | int, ...]


def faults(error: ValidationError, model: type[BaseModel]) -> Iterator[tuple[KeyPath, str]]:
    """Each key that is wrong, and why: "comparator.theta_on: Input should be greater than 0, not -1"."""
    for fault in error.errors():
        yield fault["loc"], _one(fault, model)


def explain(error: ValidationError, model: type[BaseModel]) -> str:
    """All faults on one line."""
    return "; ".join(text for _, text in faults(error, model))


def dotted(path: Sequence[str | int]) -> str:
    return ".".join(str(part) for part in path)


def one_line(text: object) -> str:
    return " ".join(str(text).split())


def where(error: BaseException) -> str:
    """An error of ours, and the line of code it comes from, for a report."""
    place = traceback.extract_tb(error.__traceback__)[-1]
    return f"{one_line(repr(error))} in {place.filename}, line {place.lineno}"


def _one(fault: Any, model: type[BaseModel]) -> str:
    *above, key = fault["loc"] or ("it",)
    if fault["type"] == "extra_forbidden":
        return f"{dotted([*above, key])}: there is no such key, only {', '.join(_keys(above, model))}"
    fault_type, message = fault["type"], fault["msg"].removeprefix("Value error, ")
    if fault_type == "string_pattern_mismatch":
        message = f"give it like {_example([*above, key], model)}"
    elif fault_type in WORDS:
        message = WORDS[fault_type].format(key=dotted([*above, key]))
    given = reprlib.repr(fault["input"])  # bounded: a few lines of YAML can mean a billion words
    given = given if len(given) <= SHOWN else given[:SHOWN] + "..."
    return one_line(f"{dotted([*above, key])}: {message}, not {given}")


def _example(path: Sequence[str | int], model: type[BaseModel]) -> str:
    """How the value at `path` may look."""
    *above, key = path
    examples = _section(above, model).model_fields[str(key)].examples or ["its pattern"]
    return str(examples[0])


def _keys(path: Sequence[str | int], model: type[BaseModel]) -> list[str]:
    """The keys of the section at `path`."""
    return list(_section(path, model).model_fields)


def _section(path: Sequence[str | int], model: type[BaseModel]) -> type[BaseModel]:
    left = iter(path)
    for part in left:
        inner = model.model_fields[str(part)].annotation
        if get_origin(inner) in (dict, tuple):  # of sections, by names of the user's own or in a row
            next(left)
            inner = get_args(inner)[get_origin(inner) is dict]
        assert isinstance(inner, type)
        assert issubclass(inner, BaseModel)
        model = inner
    return model
