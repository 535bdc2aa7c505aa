"""The guard in front of a real web server: hosts, origins, tokens, sessions, policies."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import httpx
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from voltcam_client import Control, ControlError
from voltcam_server.access import Tokens
from voltcam_server.transports import WebSocketTransport

from ..rig import SCENE, app_of, emulating, open_access, running, web_server

VIEW, CONTROL = "view-" + "v" * 20, "control-" + "c" * 20


@pytest.fixture(params=[False, True], ids=["open", "with tokens"])
def tokens(request: pytest.FixtureRequest) -> Tokens:
    return Tokens([("view", VIEW), ("control", CONTROL)] if request.param else [])


@pytest.fixture
def address(tokens: Tokens, tmp_path: Path) -> Iterator[str]:
    access = replace(open_access(tmp_path), tokens=tokens, hosts=["robot.local"])
    websockets = WebSocketTransport("here")
    with (
        emulating(SCENE) as (emulator, _),
        web_server(app_of(running(emulator, websockets), access=access)) as where,
    ):
        yield where


def bearer(token: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {token}"}


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:8560", "127.0.0.1.evil.example", "", "[::1", "robot"]
)
def test_a_name_that_was_made_to_point_here_is_refused(host: str, address: str) -> None:
    """DNS rebinding: the page's own host is this daemon then, so that host and origin agree."""
    headers = {"Host": host, "Origin": f"http://{host}", **bearer(CONTROL)}
    url = f"http://{address}/api/v1/parameters"
    for answer in (
        httpx.get(url, headers=headers, trust_env=False),
        httpx.patch(url, json={"temperature_c": 40}, headers=headers, trust_env=False),
        httpx.get(f"http://{address}/", headers=headers, trust_env=False),
    ):
        assert answer.status_code in (400, 403)


@pytest.mark.parametrize(
    "host", ["localhost:1", "[::1]:8560", "10.1.2.3", "robot.local", "ROBOT.local:80", "localhost."]
)
def test_names_that_are_ours_are_not(host: str, address: str) -> None:
    headers = {"Host": host, **bearer(CONTROL)}
    assert httpx.get(f"http://{address}/api/v1/status", headers=headers, trust_env=False).status_code == 200


@pytest.mark.parametrize(
    "origin", ["http://[", "null", "http://elsewhere.example", "x" * 5000, "http://[::1"]
)
def test_foreign_and_broken_origins_are_refused(origin: str, address: str) -> None:
    headers = {"Origin": origin, **bearer(CONTROL)}
    answer = httpx.get(f"http://{address}/api/v1/status", headers=headers, trust_env=False)
    assert answer.status_code == 403
    assert "\n" not in answer.json()["detail"]
    with pytest.raises(InvalidStatus):
        connect(f"ws://{address}/api/v1/events", additional_headers=headers, proxy=None)


def test_no_page_may_frame_ours(address: str) -> None:
    for path in ("", "main.js", "api/v1/status", "nothing"):
        headers = httpx.get(f"http://{address}/{path}", trust_env=False).headers
        assert "frame-ancestors 'none'" in headers["content-security-policy"]
        assert headers["x-frame-options"] == "DENY"
        assert headers["x-content-type-options"] == "nosniff"


PATCHED = ("PATCH", "parameters", {"temperature_c": 30})


def test_roles(address: str, tokens: Tokens) -> None:
    with httpx.Client(base_url=f"http://{address}/api/v1/", trust_env=False) as http:
        method, path, body = PATCHED
        seen = [
            (
                http.get("status", headers=headers).status_code,
                http.request(method, path, json=body, headers=headers).status_code,
            )
            for headers in ({}, bearer("wrong"), bearer(VIEW), bearer(CONTROL))
        ]
        assert seen == ([(401, 401), (401, 401), (200, 403), (200, 200)] if tokens else [(200, 200)] * 4)
    assert httpx.get(f"http://{address}/readyz", trust_env=False).status_code in (200, 503)
    assert httpx.get(f"http://{address}/metrics", trust_env=False).status_code == (401 if tokens else 200)


def test_a_browser_gets_a_session_for_its_token(address: str, tokens: Tokens) -> None:
    with httpx.Client(base_url=f"http://{address}/api/v1/", trust_env=False) as http:
        assert http.get("session").json() == {
            "role": None if tokens else "control",
            "needs_token": bool(tokens),
        }
        assert http.post("session", json={"token": "wrong"}).status_code == (401 if tokens else 200)
        answer = http.post("session", json={"token": VIEW})
        assert answer.json()["role"] == ("view" if tokens else "control")
        cookie = answer.headers["set-cookie"].lower()
        assert "httponly" in cookie
        assert "samesite=strict" in cookie
        assert VIEW not in cookie
        assert http.get("status").status_code == 200
        assert http.patch("parameters", json={}).status_code == (403 if tokens else 200)
        value = http.cookies["voltcam_session"]
        with connect(
            f"ws://{address}/api/v1/events",
            additional_headers={"Cookie": f"voltcam_session={value}"},
            proxy=None,
        ):
            pass
        http.delete("session")
        headers = {"Cookie": f"voltcam_session={value}"}
        assert http.get("status", headers=headers).status_code == (401 if tokens else 200)


def test_the_stream_needs_a_token_where_there_is_one(address: str, tokens: Tokens) -> None:
    if tokens:
        with pytest.raises(InvalidStatus):
            connect(f"ws://{address}/api/v1/events", proxy=None)
    with connect(f"ws://{address}/api/v1/events", additional_headers=bearer(VIEW), proxy=None):
        pass


def test_the_client_has_its_token_from_the_environment(
    address: str, tokens: Tokens, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("VOLTCAM_TOKEN", raising=False)
    if tokens:
        with pytest.raises(ControlError, match="token"):
            Control(f"http://{address}").status()
    assert Control(f"http://{address}", token=VIEW).status()["uptime_s"] > 0
    monkeypatch.setenv("VOLTCAM_TOKEN", CONTROL)
    assert Control(f"http://{address}").set({"temperature_c": 31})["parameters_version"] >= 1


@pytest.mark.parametrize("name", ["../out.npz", "/etc/out.npz", "a\0.npz", "x" * 300 + ".npz"])
def test_a_recording_stays_in_its_folder(name: str, address: str, tmp_path: Path) -> None:
    answer = httpx.post(
        f"http://{address}/api/v1/recording", json={"path": name}, headers=bearer(CONTROL), trust_env=False
    )
    assert answer.status_code == 403
    assert not list(tmp_path.parent.glob("out*"))
