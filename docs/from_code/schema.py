"""JSON schema in words."""

from typing import Any

import yaml

from .markdown import name, plain, table

Schema = dict[str, Any]
WORDS = {
    "integer": "whole number",
    "number": "number",
    "string": "text",
    "boolean": "true or false",
    "null": "none",
}
TO_PARAMETERS = "[parameters](parameters.md), nested by effect"


def fields(schema: Schema, linked: dict[str, str], answer: bool = False) -> str:
    """A table of an object's keys; linked: where each part that has a section of its own is, as Markdown.

    What an answer has needs no default.
    """
    rows = [
        (
            name(key),
            kind(value, linked),
            "" if answer else "needed" if key in schema.get("required", []) else _default(value),
            plain(value.get("description", "")),
        )
        for key, value in schema.get("properties", {}).items()
    ]
    filled = [column for column in range(4) if column < 2 or any(row[column] for row in rows)]
    head = ("key", "value", "default", "meaning")
    return table([head[column] for column in filled], ([row[column] for column in filled] for row in rows))


def kind(schema: Schema, linked: dict[str, str]) -> str:
    """What a value may be, in words."""
    if "$ref" in schema:
        part = schema["$ref"].rpartition("/")[2]
        return linked.get(part, part)
    if "anyOf" in schema:
        return " or ".join(dict.fromkeys(kind(one, linked) for one in schema["anyOf"]))
    if "allOf" in schema:
        return kind(schema["allOf"][0], linked)
    if "enum" in schema or "const" in schema:
        values = schema.get("enum", [schema.get("const")])
        return ", ".join(name(value) for value in values)
    if schema.get("type") == "array":
        return f"list of: {kind(schema.get('items', {}), linked)}"
    if schema.get("type") == "object":
        inner = schema.get("additionalProperties")
        return f"by name: {kind(inner, linked)}" if isinstance(inner, dict) and inner else "object"
    return WORDS.get(schema.get("type", ""), "anything") + _limits(schema)


def _limits(schema: Schema) -> str:
    low, high, above = (_number(schema.get(key)) for key in ("minimum", "maximum", "exclusiveMinimum"))
    if above:
        return f", above {above}" + (f", to {high}" if high else "")
    if low:
        return f", {low} to {high}" if high else f", {low} or more"
    if high:
        return f", {high} at most"
    return f" as {name(schema['examples'][0])}" if schema.get("examples") else ""


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:,.12g}".replace(",", " ")


def _default(schema: Schema) -> str:
    """As YAML has it."""
    default = schema.get("default")
    if default in (None, {}, []):
        return ""
    return name(yaml.safe_dump(default, default_flow_style=True).removesuffix("...\n").strip())
