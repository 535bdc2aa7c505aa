"""The REST interface, from the OpenAPI document that the daemon gives."""

from typing import Any

from voltcam_server.access import AccessSettings, SourceRules, Tokens
from voltcam_server.api import Access, create_app
from voltcam_server.cameras import Cameras
from voltcam_server.reload import ReloadAnswer
from voltcam_server.request_body import REASONS

from .markdown import name, plain, sentence, table
from .schema import TO_PARAMETERS, Schema, fields, kind

EFFECTS_OF = ("Parameters", "Body-Parameters")
WAYS = ("get", "post", "put", "patch", "delete")


def document() -> dict[str, Any]:
    """The OpenAPI document of a daemon, made without cameras."""
    access = Access(SourceRules(AccessSettings()), Tokens([]))
    openapi: dict[str, Any] = create_app(Cameras([]), access, ReloadAnswer).openapi()
    return openapi


def chapter() -> str:
    """A table of all requests, a section for each, and one for each kind of answer."""
    paths = document()["paths"]
    parts = document()["components"]["schemas"]
    linked = dict.fromkeys(EFFECTS_OF, TO_PARAMETERS) | {
        part: f"[{_title(part)}](#{_title(part).lower()})" for part in _answers(paths, parts)
    }
    requests = [
        (way, path, each) for path, ways in paths.items() for way, each in ways.items() if way in WAYS
    ]
    text = [
        "## Refusals\n",
        table(("status", "meaning"), ((code, plain(why)) for code, why in REASONS.items())),
    ]
    text.append("## All requests\n")
    rows = [
        (f"[`{way.upper()} {path}`](#{_anchor(way, path)})", plain(_first(e))) for way, path, e in requests
    ]
    text.append(table(("request", "does"), rows))
    text += [_request(way, path, each, linked) for way, path, each in requests]
    text.append("## Answers and bodies\n")
    text += [_part(part, parts[part], linked) for part in linked if part not in EFFECTS_OF]
    return "\n".join(text)


def _title(part: str) -> str:
    """Of two parts with one name, OpenAPI has the module before it."""
    return part.rpartition("__")[2]


def _anchor(way: str, path: str) -> str:
    return f"{way}-{path}".replace("/", "").replace(".", "").lower()


def _first(each: Schema) -> str:
    return sentence((each.get("description") or each.get("summary", "")).split("\n\n")[0])


def _request(way: str, path: str, each: Schema, linked: dict[str, str]) -> str:
    text = [f"### `{way.upper()} {path}`\n", plain(_first(each)) + "\n"]
    query = [one for one in each.get("parameters", []) if one["name"] != "camera"]
    if query:
        rows = [
            (name(one["name"]), kind(one["schema"], linked), plain(one.get("description", "")))
            for one in query
        ]
        text.append(table(("in the query", "value", "meaning"), rows))
    if "requestBody" in each:
        for media, content in each["requestBody"]["content"].items():
            text.append(_body(media, content["schema"], linked))
    answers = each["responses"]
    given = "; ".join(
        f"{status}, {_content(answers[status], linked)}" for status in answers if status < "300"
    )
    refused = ", ".join(status for status in sorted(answers) if status >= "400")
    camera = " `?camera=NAME` chooses the camera." if len(each.get("parameters", [])) > len(query) else ""
    text.append(f"Answer: {given}. Refusals: {refused}.{camera}\n")
    return "\n".join(text)


def _body(media: str, schema: Schema, linked: dict[str, str]) -> str:
    if "temperature_c" in schema.get("properties", {}):
        what = "a [camera file](camera-file.md)" if media.endswith("yaml") else TO_PARAMETERS
        return f"The body, `{media}`: {what}.\n"
    words = plain(sentence(schema.get("description", "")))
    return f"The body, `{media}`. {words}\n\n{fields(schema, linked)}"


def _content(answer: Schema, linked: dict[str, str]) -> str:
    return "; ".join(
        kind(content["schema"], linked)
        if content.get("schema") and media == "application/json"
        else name(media)
        for media, content in answer.get("content", {}).items()
    )


def _part(part: str, schema: Schema, linked: dict[str, str]) -> str:
    text = [f"### {_title(part)}\n", plain(sentence(schema.get("description", ""))) + "\n"]
    if schema.get("properties"):
        text.append(fields(schema, linked, answer=True))
    return "\n".join(text)


def _answers(paths: Schema, parts: Schema) -> list[str]:
    """The parts that answers and bodies are made of, in the order in which they are met; no effects."""
    found: list[str] = []

    def look(value: Any) -> None:
        if isinstance(value, dict):
            for key, one in value.items():
                if key == "$ref":
                    part = one.rpartition("/")[2]
                    if part not in found and part not in EFFECTS_OF and part in parts:
                        found.append(part)
                        look(parts[part])
                else:
                    look(one)
        elif isinstance(value, list):
            for one in value:
                look(one)

    for path, ways in paths.items():
        for way, each in ways.items():
            body = each.get("requestBody", {}).get("content", {})
            bodies = [
                one for one in body.values() if "temperature_c" not in one["schema"].get("properties", {})
            ]
            look([each["responses"], bodies, path, way])
    return found
