"""Every key of the config file, from the models that read it."""

from typing import Any

from voltcam_server.settings import Settings

from .markdown import plain, sentence
from .schema import TO_PARAMETERS, fields


def chapter() -> str:
    """The file's own keys, then a section for each key that has several."""
    schema = Settings.model_json_schema()
    parts: dict[str, Any] = schema["$defs"]
    linked = {"Parameters": TO_PARAMETERS, "CameraSettings": "keys of a camera, as above"}
    sections = {}
    for key, value in schema["properties"].items():
        part = value.get("$ref", "").rpartition("/")[2]
        if part and part not in linked:
            linked[part] = f"[section](#{key})"
            sections[key] = parts[part]
    text = ["## The file\n", fields(schema, linked)]
    for key, part in sections.items():
        text += [f"## `{key}`\n", plain(sentence(part.get("description", ""))) + "\n", fields(part, linked)]
    return "\n".join(text)
