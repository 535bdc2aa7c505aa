"""The web application: health, origins and its description, at a real web server."""

from collections.abc import Iterator

import httpx
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from voltcam_server.emulator import Emulator
from voltcam_server.transports import WebSocketTransport

from .rig import SCENE, Api, app_of, running, serving, tiny, web_server


@pytest.fixture(scope="module")
def api() -> Iterator[Api]:
    with serving() as api:
        yield api


def test_not_ready_before_the_first_frame() -> None:
    emulator = Emulator(tiny(), SCENE)
    with web_server(app_of(running(emulator, WebSocketTransport("here")))) as address:
        assert httpx.get(f"http://{address}/readyz", trust_env=False).status_code == 503
        assert httpx.get(f"http://{address}/healthz", trust_env=False).status_code == 200
        emulator.failure = RuntimeError("a bug")
        assert httpx.get(f"http://{address}/healthz", trust_env=False).status_code == 503


def test_pages_of_other_sites_are_kept_out(api: Api) -> None:
    other = {"Origin": "http://elsewhere.example"}
    own = {"Origin": f"http://{api.address}"}
    before = api.http.get("parameters").json()
    change = {"temperature_c": 60}
    assert "elsewhere.example" in api.refused(403, "PATCH", "parameters", json=change, headers=other)
    assert api.http.get("parameters").json() == before
    response = api.http.patch("parameters", json={}, headers=own)
    assert response.is_success
    assert not [name for name in response.headers if name.startswith("access-control")]
    with pytest.raises(InvalidStatus), connect(f"ws://{api.address}/api/v1/events", additional_headers=other):
        pass


def test_openapi_describes_the_bodies(api: Api) -> None:
    paths = api.http.get("openapi.json").json()["paths"]
    assert {path.removeprefix("/api/v1") for path in paths} == {
        "/camera",
        "/cameras",
        "/reload",
        "/parameters",
        "/parameters/file",
        "/parameters/schema",
        "/presets",
        "/biases",
        "/source",
        "/recording",
        "/diagnosis",
        "/diagnosis/accept",
        "/diagnosis/revert",
        "/diagnosis/report",
        "/session",
        "/status",
    }
    assert "requestBody" in paths["/api/v1/parameters"]["patch"]
