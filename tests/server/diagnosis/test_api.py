"""Routes of the diagnosis over a stub of its runner: what is asked of it, and what is refused before."""

import json
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from fastapi.responses import JSONResponse
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from voltcam_server.access import AccessError, AccessSettings, SourceRules
from voltcam_server.cameras import NoCameraError
from voltcam_server.diagnosis import api
from voltcam_server.diagnosis.api import diagnosis_routes
from voltcam_server.diagnosis.models import DiagnosisRequest, DiagnosisState

from ..rig import PATIENCE_S, web_server


class Runner:
    """Keeps what is asked of it."""

    def __init__(self) -> None:
        self.state, self.changes = DiagnosisState(), 0
        self.report: Path | None = None
        self.asked: list[DiagnosisRequest] = []

    def start(self, request: DiagnosisRequest) -> DiagnosisState:
        self.asked.append(request)
        return self.state

    def accept(self) -> int:
        return 7

    def revert(self) -> int:
        return 8

    def end(self) -> DiagnosisState:
        return DiagnosisState(state="failed", error="ended")


@pytest.fixture
def runner() -> Runner:
    return Runner()


@pytest.fixture
def client(runner: Runner, tmp_path: Path) -> Iterator[httpx.Client]:
    def get(name: str | None = None) -> Any:
        if name not in (None, "left"):
            raise NoCameraError(f"no camera {name}")
        return SimpleNamespace(diagnosis=runner)

    rules = SourceRules(AccessSettings(source_folders=[tmp_path]))
    app = FastAPI()
    app.include_router(diagnosis_routes(SimpleNamespace(get=get), rules))  # type: ignore[arg-type]
    app.add_exception_handler(AccessError, lambda _, error: JSONResponse(str(error), 403))
    with (
        web_server(app) as address,
        httpx.Client(base_url=f"http://{address}", trust_env=False) as client,
    ):
        yield client


def progress(client: httpx.Client, query: str = "") -> ClientConnection:
    return connect(
        f"ws://{client.base_url.host}:{client.base_url.port}/diagnosis/progress{query}", proxy=None
    )


def test_a_reference_is_resolved_below_the_folders(
    client: httpx.Client, runner: Runner, tmp_path: Path
) -> None:
    (tmp_path / "walk.npz").touch()
    answer = client.post("/diagnosis?camera=left", json={"reference": "walk.npz", "seconds": 3})
    assert (answer.status_code, answer.json()["state"]) == (201, "idle")
    (request,) = runner.asked
    assert (request.reference, request.stream, request.seconds) == (
        str(tmp_path.resolve() / "walk.npz"),
        None,
        3,
    )


def test_a_stream_of_this_machine_is_passed_on(client: httpx.Client, runner: Runner) -> None:
    assert client.post("/diagnosis", json={"stream": "tcp://127.0.0.1:5561"}).status_code == 201
    assert runner.asked[0].stream == "tcp://127.0.0.1:5561"


@pytest.mark.parametrize("body", [{"reference": "../walk.npz"}, {"stream": "tcp://10.0.0.1:5561"}])
def test_what_may_not_be_named_does_not_reach_the_runner(
    body: dict[str, str], client: httpx.Client, runner: Runner
) -> None:
    assert client.post("/diagnosis", json=body).status_code == 403
    assert runner.asked == []


def test_versions_ends_and_states_are_the_runner_s(client: httpx.Client) -> None:
    assert client.post("/diagnosis/accept").json() == {"parameters_version": 7}
    assert client.post("/diagnosis/revert").json() == {"parameters_version": 8}
    assert client.delete("/diagnosis").json()["error"] == "ended"
    assert client.get("/diagnosis").json() == DiagnosisState().model_dump(mode="json")


def test_the_report_is_there_when_it_is(client: httpx.Client, runner: Runner, tmp_path: Path) -> None:
    for report in (None, tmp_path / "report.html"):
        runner.report = report
        answer = client.get("/diagnosis/report")
        assert answer.status_code == 404
        assert "there is no report" in answer.json()["detail"]
    (tmp_path / "report.html").write_text("<h1>found</h1>")
    answer = client.get("/diagnosis/report")
    assert (answer.text, answer.headers["content-type"]) == ("<h1>found</h1>", "text/html; charset=utf-8")


def test_progress_is_pushed_now_and_after_each_change(
    client: httpx.Client, runner: Runner, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(api, "PUSH_PERIOD_S", 0.01)
    with progress(client) as socket:
        assert heard(socket)["progress"] == []
        socket.send("what a client says matters to nobody")
        runner.state, runner.changes = DiagnosisState(state="running", progress=["looking"]), 1
        state = heard(socket)
        assert (state["state"], state["progress"]) == ("running", ["looking"])


def test_progress_of_no_camera_is_closed_with_the_reason(client: httpx.Client) -> None:
    with progress(client, "?camera=up") as socket, pytest.raises(ConnectionClosed) as closed:
        socket.recv(timeout=PATIENCE_S)
    assert closed.value.rcvd is not None
    assert (closed.value.rcvd.code, closed.value.rcvd.reason) == (1008, "no camera up")


def heard(socket: ClientConnection) -> Any:
    return json.loads(socket.recv(timeout=PATIENCE_S))
