"""A diagnosis beside a running camera: a real web server, a stub in place of the diagnosing process."""

import contextlib
import json
import os
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest
from websockets.sync.client import ClientConnection, connect

from voltcam_client import Control, ControlError
from voltcam_server.diagnosis.runner import DiagnosisRunner
from voltcam_server.emulator import Emulator
from voltcam_server.transports import WebSocketTransport, ZeroMQTransport
from voltcam_simulator import Camera
from voltcam_video import SourceRequest

from ..rig import PATIENCE_S, SCENE, Listener, app_of, running, tiny, web_server

# It says who it is, waits for the order how to end, and takes what it finds from the camera it is given.
STUB = """
import json, os, pathlib, signal, sys, yaml
orders, recording, _, camera, _, out, _, seconds = sys.argv[1:]
if "stubborn" in recording:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
print(f"process {os.getpid()} priority {os.nice(0)} seconds {seconds}", flush=True)
with open(orders) as file:
    order = file.readline().strip()
if order == "refuse":
    sys.exit("voltcam: walk.npz has no frames: record some")
if order == "break":
    raise KeyError("k7")
extended, effects = yaml.safe_load(open(camera)), []
if order == "find":
    extended["refractory_period"]["period_us"], effects = 300.0, [{"name": "refractory_period"}]
result = {"verdict": "effects" if effects else "none", "effects": effects, "residual": None}
result["sentence"] = "This camera lacks a dead time." if effects else "Nothing is missing."
out = pathlib.Path(out)
(out / "camera.yaml").write_text(yaml.safe_dump(extended))
(out / "result.json").write_text(json.dumps(result))
(out / "report.html").write_text("<h1>what was found</h1>")
"""


@dataclass
class Bench:
    emulator: Emulator
    listener: Listener
    zmq: str
    control: Control
    http: httpx.Client
    progress: ClientConnection
    orders: int
    walk: Path

    def order(self, what: str) -> None:
        """Let the stub go on."""
        os.write(self.orders, f"{what}\n".encode())

    def pushed(self, condition: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
        """The first state that comes over the WebSocket and is such."""
        deadline = time.monotonic() + PATIENCE_S
        while True:
            state = json.loads(self.progress.recv(timeout=deadline - time.monotonic()))
            if condition(state):
                return dict(state)

    def started(self, **request: Any) -> int:
        """A diagnosis that waits for its order; the stub's process."""
        self.control.start_diagnosis(**request or {"reference": self.walk})
        said = self.pushed(lambda it: it["progress"] and it["progress"][-1].startswith("process"))
        assert said["progress"][-1].split()[2:4] == ["priority", "19"]
        return int(said["progress"][-1].split()[1])

    def done(self, order: str) -> dict[str, Any]:
        self.order(order)
        return self.pushed(lambda it: it["state"] in ("done", "failed"))

    def parameters(self) -> dict[str, Any]:
        return dict(self.control.parameters()["parameters"])

    def holds_in_packets(self, version: int) -> None:
        self.listener.wait(lambda it: it.packets[-1].parameters_version == version)


@contextlib.contextmanager
def publishing(source: SourceRequest, camera: Camera) -> Iterator[tuple[Emulator, Listener, str]]:
    """A running camera on a free ZeroMQ port."""
    zeromq, listener = ZeroMQTransport("tcp://127.0.0.1:0", "libcaer"), Listener()
    emulator = Emulator(camera, source, transports=[zeromq, listener])
    try:
        emulator.start()
        zeromq.start()
        listener.start()
        yield emulator, listener, zeromq.endpoint
    finally:
        emulator.stop()
        listener.stop()
        zeromq.stop()


@contextlib.contextmanager
def diagnosing(tmp_path: Path) -> Iterator[Bench]:
    """A camera whose diagnosis is the stub, which waits for orders."""
    camera, walk, fifo = tiny(), tmp_path / "walk.npz", tmp_path / "orders"
    walk.touch()
    os.mkfifo(fifo)
    orders = os.open(fifo, os.O_RDWR)  # both, so that nobody waits for a reader
    with publishing(SCENE, camera) as (emulator, listener, zmq):
        command = [sys.executable, "-c", STUB, str(fifo)]
        diagnosis = DiagnosisRunner(emulator, zmq, command=command, work=tmp_path)
        try:
            with (
                web_server(app_of(running(emulator, WebSocketTransport(""), diagnosis=diagnosis))) as address,
                httpx.Client(base_url=f"http://{address}/api/v1/", trust_env=False) as http,
                connect(f"ws://{address}/api/v1/diagnosis/progress") as progress,
            ):
                control = Control(f"http://{address}", timeout_s=PATIENCE_S)
                yield Bench(emulator, listener, zmq, control, http, progress, orders, walk)
        finally:
            diagnosis.stop()
            os.close(orders)


def refusal(code: int, ask: Callable[[], object]) -> str:
    with pytest.raises(ControlError) as caught:
        ask()
    assert caught.value.status == code
    return str(caught.value)
