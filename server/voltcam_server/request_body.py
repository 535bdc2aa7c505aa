"""JSON bodies, read strictly, and refusals in one line."""

import json
from typing import Any, NoReturn, TypeVar

import yaml
from pydantic import BaseModel, ConfigDict, ValidationError
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request

from voltcam_simulator import Camera, Parameters

from .problems import explain, one_line

BODY_BYTES = 65536
PART = "Body-"  # parts of a body have names of their own: an answer's may be less strict
REASONS = {
    400: "the body is no JSON object",
    401: "a token is needed",
    403: "this token, or this daemon's settings, do not allow it",
    404: "there is no such thing",
    409: "not now",
    413: "the body is too long",
    422: "a key or value that cannot be",
}
Model = TypeVar("Model", bound=BaseModel)


async def read_object(request: Request) -> dict[str, Any]:
    """The body as a JSON object. Raises HTTPException 413 for more than BODY_BYTES, 400 for anything else."""
    body = await _read(request)
    try:
        content = json.loads(body, parse_constant=_no_number)
    except (ValueError, RecursionError) as error:
        raise HTTPException(400, f"the body is not JSON: {one_line(error)}") from None
    if not isinstance(content, dict):
        raise HTTPException(400, 'the body must be a JSON object, such as {"comparator": {"theta_on": 1.2}}')
    return content


async def read_camera(request: Request) -> Camera:
    """The body as a camera file. Raises HTTPException, 422 for what is none."""
    body = await _read(request)
    try:
        content = yaml.safe_load(body)
        if not isinstance(content, dict):
            raise HTTPException(400, "the body must be a camera file: name, width, height, effects")
        return Camera.from_mapping(content)
    except ValidationError as error:
        raise refusal(error, Parameters) from None
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as error:
        raise HTTPException(400, f"the body is not readable as YAML: {one_line(error)}") from None
    except (ValueError, TypeError) as error:
        raise HTTPException(422, one_line(error)) from None


async def _read(request: Request) -> bytes:
    """The body. Raises HTTPException 413 for more than BODY_BYTES, 400 where it does not come."""
    body = bytearray()
    try:
        async for chunk in request.stream():
            body += chunk
            if len(body) > BODY_BYTES:
                raise HTTPException(413, f"the body is longer than {BODY_BYTES} bytes: send less at once")
    except ClientDisconnect:
        raise HTTPException(400, "the body did not come") from None
    return bytes(body)


async def read_model(request: Request, model: type[Model]) -> Model:
    """The body as a model. Raises HTTPException, 422 for unknown keys and wrong values."""
    try:
        return model.model_validate(await read_object(request))
    except ValidationError as error:
        raise refusal(error, model) from None


def refusal(error: ValidationError, model: type[BaseModel]) -> HTTPException:
    return HTTPException(422, explain(error, model))


class Problem(BaseModel):
    """Why a request was refused. Nothing has changed."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    detail: str
    """what is wrong, and the remedy, in one line"""


def refuses(*codes: int) -> dict[int | str, dict[str, Any]]:
    """What OpenAPI says of a route's refusals."""
    return {code: {"model": Problem, "description": REASONS[code]} for code in codes}


def body_of(model: type[BaseModel]) -> dict[str, Any]:
    """What OpenAPI says of a body that is read here; its parts are for `openapi.describe` to put in place."""
    schema = model.model_json_schema(ref_template=f"#/components/schemas/{PART}{{model}}")
    return {"requestBody": {"required": True, "content": {"application/json": {"schema": schema}}}}


def camera_body() -> dict[str, Any]:
    """The same of a camera file: `Camera`, its parameters not under a key of their own."""
    body = body_of(Parameters)
    content = body["requestBody"]["content"]
    schema = content["application/json"]["schema"]
    own = {name: Camera.model_json_schema()["properties"][name] for name in ("name", "width", "height")}
    schema["properties"] = own | schema["properties"]
    schema["dependentRequired"] = {"width": ["height"], "height": ["width"]}
    body["requestBody"]["content"] = {"application/yaml": content["application/json"]}
    return body


def _no_number(name: str) -> NoReturn:
    raise ValueError(f"{name} is no number in JSON: give a finite one")
