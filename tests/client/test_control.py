"""Control against a stand-in for the daemon."""

import json
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest

from voltcam_client import Control, ControlError


class Daemon(ThreadingHTTPServer):
    """Gives one answer to everything, and remembers what was asked."""

    daemon_threads = True

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Handler)
        self.url = f"http://127.0.0.1:{self.server_port}"
        self.asked: list[tuple[str, str, Any]] = []
        self.status, self.body = 200, b"{}"
        self.hold: threading.Event | None = None


class Handler(BaseHTTPRequestHandler):
    server: Daemon  # pyright: ignore[reportIncompatibleVariableOverride]

    def answer(self) -> None:
        length = int(self.headers["Content-Length"] or 0)
        self.server.asked.append((self.command, self.path, json.loads(self.rfile.read(length) or b"null")))
        if self.server.hold:
            self.server.hold.wait(10)
            return
        self.send_response(self.server.status)
        self.send_header("Content-Length", str(len(self.server.body)))
        self.end_headers()
        self.wfile.write(self.server.body)

    do_GET = do_PATCH = do_PUT = do_POST = do_DELETE = answer  # noqa: N815

    def log_message(self, format: str, *args: object) -> None:
        pass


@pytest.fixture
def daemon() -> Iterator[Daemon]:
    with Daemon() as daemon:
        thread = threading.Thread(target=daemon.serve_forever, args=(0.01,))
        thread.start()
        yield daemon
        daemon.shutdown()
        thread.join(10)


def test_each_method_is_one_request(daemon: Daemon) -> None:
    control = Control(daemon.url + "/")
    control.camera()
    control.parameters()
    control.schema()
    control.source()
    control.set_source("a.mp4", loop=True)
    control.start_recording("run.npz")
    control.stop_recording()
    control.start_diagnosis(Path("walk.npz"))
    control.start_diagnosis(stream="tcp://robot:5560", seconds=5)
    control.diagnosis()
    control.end_diagnosis()
    control.accept_diagnosis()
    control.revert_diagnosis()
    control.status()
    assert daemon.asked == [
        ("GET", "/api/v1/camera", None),
        ("GET", "/api/v1/parameters", None),
        ("GET", "/api/v1/parameters/schema", None),
        ("GET", "/api/v1/source", None),
        ("PUT", "/api/v1/source", {"uri": "a.mp4", "loop": True}),
        ("POST", "/api/v1/recording", {"path": "run.npz"}),
        ("DELETE", "/api/v1/recording", None),
        ("POST", "/api/v1/diagnosis", {"reference": "walk.npz"}),
        ("POST", "/api/v1/diagnosis", {"stream": "tcp://robot:5560", "seconds": 5}),
        ("GET", "/api/v1/diagnosis", None),
        ("DELETE", "/api/v1/diagnosis", None),
        ("POST", "/api/v1/diagnosis/accept", None),
        ("POST", "/api/v1/diagnosis/revert", None),
        ("GET", "/api/v1/status", None),
    ]


@pytest.mark.parametrize(
    ("changes", "body"),
    [
        ({"comparator": {"theta_on": 1.2}}, {"comparator": {"theta_on": 1.2}}),
        ({"comparator.theta_on": 1.2}, {"comparator": {"theta_on": 1.2}}),
        (
            {"comparator": {"theta_on": 1.2}, "comparator.theta_off": 2, "temperature_c": 40},
            {"comparator": {"theta_on": 1.2, "theta_off": 2}, "temperature_c": 40},
        ),
        (
            {"comparator.theta_off": 2, "comparator": {"theta_on": 1.2}},
            {"comparator": {"theta_on": 1.2, "theta_off": 2}},
        ),
    ],
)
def test_changes_are_nested_or_by_path(daemon: Daemon, changes: dict[str, Any], body: dict[str, Any]) -> None:
    before = json.dumps(changes)
    Control(daemon.url).set(changes)
    assert daemon.asked == [("PATCH", "/api/v1/parameters", body)]
    assert json.dumps(changes) == before


def test_the_answer_is_returned(daemon: Daemon) -> None:
    daemon.body = b'{"comparator": {"theta_on": 1.0}}'
    assert Control(daemon.url).parameters() == {"comparator": {"theta_on": 1.0}}


def test_an_empty_answer_is_an_empty_object(daemon: Daemon) -> None:
    daemon.status, daemon.body = 204, b""
    assert Control(daemon.url).stop_recording() == {}


@pytest.mark.parametrize(
    ("detail", "line"),
    [
        ("comparator.theta_on must be above 0: give 0.01 to 100", None),
        ("two\nlines", "two lines"),
        (
            [
                {
                    "loc": ["body", "comparator", "theta_on"],
                    "msg": "Input should be greater than 0",
                    "type": "x",
                },
                {"loc": ["body", "noise", 1], "msg": "Extra inputs are not permitted"},
            ],
            "comparator.theta_on: Input should be greater than 0; noise.1: Extra inputs are not permitted",
        ),
    ],
)
def test_a_refusal_is_one_line(daemon: Daemon, detail: Any, line: str | None) -> None:
    daemon.status, daemon.body = 422, json.dumps({"detail": detail}).encode()
    with pytest.raises(ControlError) as caught:
        Control(daemon.url).set({"comparator.theta_on": -1})
    assert str(caught.value) == (line or detail)
    assert caught.value.status == 422


@pytest.mark.parametrize("body", [b"<html>Not here</html>", b"[]", b"", b'{"detail": [1]}'])
def test_an_error_that_is_not_the_daemons(daemon: Daemon, body: bytes) -> None:
    daemon.status, daemon.body = 404, body
    with pytest.raises(ControlError, match=r"/api/v1/status answered 404 .*is it a Voltcam daemon"):
        Control(daemon.url).status()


@pytest.mark.parametrize("body", [b"<html>hello</html>", b"[1, 2]"])
def test_an_answer_that_is_not_the_daemons(daemon: Daemon, body: bytes) -> None:
    daemon.body = body
    with pytest.raises(ControlError, match="is it a Voltcam daemon"):
        Control(daemon.url).status()


def test_nobody_there(daemon: Daemon) -> None:
    with pytest.raises(
        ControlError, match=r"cannot reach http://127\.0\.0\.1:1 .*is `voltcam serve`"
    ) as caught:
        Control("http://127.0.0.1:1").status()
    assert caught.value.status is None


def test_a_daemon_that_hangs(daemon: Daemon) -> None:
    daemon.hold = threading.Event()
    with pytest.raises(ControlError, match=r"/status did not answer within 0\.1 s: give Control\(timeout_s"):
        Control(daemon.url, timeout_s=0.1).status()
    daemon.hold.set()


def test_a_change_may_take_longer_than_an_answer(daemon: Daemon, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("voltcam_client.control.LONGEST_S", 0.1)
    daemon.hold = threading.Event()
    with pytest.raises(ControlError, match=r"within 0\.1 s, and may still do it"):
        Control(daemon.url, timeout_s=0.01).set_source("rtsp://slow/")
    daemon.hold.set()


def test_a_proxy_is_not_asked(daemon: Daemon, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("http_proxy", "http://127.0.0.1:1")
    monkeypatch.delenv("no_proxy", raising=False)
    assert Control(daemon.url).status() == {}


@pytest.mark.parametrize("url", ["", "127.0.0.1:8560", "tcp://127.0.0.1:5560"])
def test_an_address_that_is_none_is_refused(url: str) -> None:
    with pytest.raises(ControlError, match="give http://HOST:PORT"):
        Control(url)
