"""The description of the REST interface, complete: bodies that are read by hand, and their parts."""

from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from .request_body import PART


def describe(app: FastAPI) -> None:
    """Give the app its OpenAPI document."""

    def openapi() -> dict[str, Any]:
        if app.openapi_schema is None:
            app.openapi_schema = _with_parts(get_openapi(title=app.title, version="1", routes=app.routes))
        return app.openapi_schema

    app.openapi = openapi  # type: ignore[method-assign]  # as FastAPI's documentation has it


def _with_parts(document: dict[str, Any]) -> dict[str, Any]:
    """With the parts of bodies among the components, where their references look for them."""
    parts = document["components"]["schemas"]
    for path in document["paths"].values():
        for operation in path.values():
            body = operation.get("requestBody")
            for content in body["content"].values() if body else ():
                schema = content["schema"]
                parts.update({PART + name: part for name, part in schema.pop("$defs", {}).items()})
    return document
