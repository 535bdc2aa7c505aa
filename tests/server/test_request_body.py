"""Bodies of requests, read in this thread: what is taken, and what is refused with which status."""

import asyncio
import json
from collections.abc import Awaitable, Callable
from typing import Any, TypeVar

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, ConfigDict
from starlette.exceptions import HTTPException
from starlette.requests import Request

from voltcam_server.request_body import (
    BODY_BYTES,
    PART,
    REASONS,
    body_of,
    camera_body,
    read_camera,
    read_model,
    read_object,
    refuses,
)
from voltcam_simulator import Camera, Parameters

T = TypeVar("T")


class Wanted(BaseModel):
    """A body of this file's."""

    model_config = ConfigDict(extra="forbid")

    path: str
    seconds: float = 1


def read(how: Callable[[Request], Awaitable[T]], *chunks: bytes, leaves: bool = False) -> T:
    messages: list[dict[str, Any]] = [
        {"type": "http.request", "body": chunk, "more_body": leaves or i + 1 < len(chunks)}
        for i, chunk in enumerate(chunks)
    ]
    messages += [{"type": "http.disconnect"}] if leaves else []
    waiting = iter(messages)

    async def receive() -> dict[str, Any]:
        return next(waiting)

    async def run() -> T:
        return await how(Request({"type": "http", "headers": []}, receive))

    return asyncio.run(run())


def refused(
    how: Callable[[Request], Awaitable[Any]], *chunks: bytes, leaves: bool = False
) -> tuple[int, str]:
    with pytest.raises(HTTPException) as caught:
        read(how, *chunks, leaves=leaves)
    assert "\n" not in caught.value.detail
    return caught.value.status_code, caught.value.detail


def wanted(request: Request) -> Awaitable[Wanted]:
    return read_model(request, Wanted)


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=8,
)


@given(st.dictionaries(st.text(), json_values, max_size=4), st.integers(1, 7))
def test_an_object_comes_as_it_was_sent_in_any_pieces(content: dict[str, Any], size: int) -> None:
    body = json.dumps(content).encode()
    pieces = [body[i : i + size] for i in range(0, len(body), size)]
    assert read(read_object, *pieces) == content


def test_the_limit_is_of_all_pieces_together() -> None:
    body = b'{"a": 1}'.ljust(BODY_BYTES)
    assert read(read_object, body[:40_000], body[40_000:]) == {"a": 1}
    assert refused(read_object, body, b" ") == (
        413,
        f"the body is longer than {BODY_BYTES} bytes: send less at once",
    )


def test_a_client_that_leaves_has_sent_no_body() -> None:
    assert refused(read_object, b'{"a"', leaves=True) == (400, "the body did not come")


@pytest.mark.parametrize("body", [b"[1]", b"3", b"null", b'"a"'])
def test_json_that_is_no_object_is_refused(body: bytes) -> None:
    code, detail = refused(read_object, body)
    assert code == 400
    assert "must be a JSON object, such as" in detail


def test_a_model_has_its_keys_and_no_others() -> None:
    assert read(wanted, b'{"path": "a.npz"}') == Wanted(path="a.npz")
    assert refused(wanted, b'{"path": "a", "second": 1}') == (
        422,
        "second: there is no such key, only path, seconds",
    )
    code, detail = refused(wanted, b'{"path": 3, "seconds": "many"}')
    assert code == 422
    assert "path: " in detail
    assert "seconds: give a number, not 'many'" in detail


@pytest.mark.parametrize("write", [yaml.safe_dump, json.dumps])
def test_a_camera_file_is_yaml_and_so_json_too(write: Callable[[Any], str]) -> None:
    camera = Camera.load("davis240c")
    content = yaml.safe_load(camera.to_yaml())
    assert read(read_camera, write(content).encode()) == camera


@pytest.mark.parametrize(
    ("body", "code", "words"),
    [
        (b"- 1", 400, "must be a camera file: name, width"),
        (b"a: [", 400, "not readable as YAML"),
        (b"\xff\xfe\x00", 400, "not readable as YAML"),
        (b"name: !!python/name:os.system x", 400, "not readable as YAML"),
        (b"width: 3", 422, "has no height"),
        (b"shutter: 3", 422, "shutter: there is no such key"),
        (b"comparator: {theta_on: -1}", 422, "comparator.theta_on: "),
    ],
)
def test_what_is_no_camera_file_is_refused(body: bytes, code: int, words: str) -> None:
    found, detail = refused(read_camera, body)
    assert found == code
    assert words in detail


def test_openapi_s_bodies_are_the_models_and_their_parts_have_names_of_their_own() -> None:
    schema = body_of(Parameters)["requestBody"]["content"]["application/json"]["schema"]
    references = [part["$ref"] for part in schema["properties"].values() if "$ref" in part]
    assert references
    assert all(ref.startswith(f"#/components/schemas/{PART}") for ref in references)
    camera = camera_body()["requestBody"]["content"]["application/yaml"]["schema"]
    assert {"name", "width", "height", "temperature_c", "comparator"} <= set(camera["properties"])
    assert camera["dependentRequired"] == {"width": ["height"], "height": ["width"]}


def test_every_refusal_has_its_reason() -> None:
    assert [answer["description"] for answer in refuses(404, 413).values()] == [REASONS[404], REASONS[413]]
    with pytest.raises(KeyError):
        refuses(418)
