"""The diagnosis beside a running camera: a real web server, a stub in place of the diagnosing process."""

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
import numpy as np
import pytest
from playwright.sync_api import expect, sync_playwright
from websockets.sync.client import ClientConnection, connect

from voltcam_client import Control, ControlError
from voltcam_client.formats import read
from voltcam_client.packet import EVENT
from voltcam_server import diagnosis as diagnosis_module
from voltcam_server import gather as gather_module
from voltcam_server.api import create_app
from voltcam_server.diagnosis import Diagnosis, DiagnosisRequest
from voltcam_server.emulator import Emulator
from voltcam_server.gather import Sample, main
from voltcam_server.transports import WebSocketTransport, ZeroMQTransport
from voltcam_simulator import Camera
from voltcam_video import SourceRequest

from .rig import PATIENCE_S, Listener, moving_frames, save_frames, tiny, until, web_server
from .test_api import about
from .test_emulator import SCENE
from .test_page import CHROMIUM, CHROMIUM_ARGS

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


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    camera, walk, fifo = tiny(), tmp_path / "walk.npz", tmp_path / "orders"
    walk.touch()
    os.mkfifo(fifo)
    orders = os.open(fifo, os.O_RDWR)  # both, so that nobody waits for a reader
    with publishing(SCENE, camera) as (emulator, listener, zmq):
        command = [sys.executable, "-c", STUB, str(fifo)]
        diagnosis = Diagnosis(emulator, zmq, command=command, work=tmp_path)
        try:
            with (
                web_server(create_app(emulator, WebSocketTransport(""), about(camera), diagnosis)) as address,
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


def test_what_is_found_is_accepted_and_reverted(bench: Bench) -> None:
    assert bench.pushed(lambda it: True)["state"] == "idle"
    bench.control.set({"temperature_c": 40})
    before = bench.parameters()
    bench.started(reference=bench.walk, seconds=2.5)
    state = bench.done("find")
    assert (state["state"], state["error"], state["acceptable"], state["revertible"]) == (
        "done",
        "",
        True,
        False,
    )
    assert state["progress"][-1].endswith("seconds 2.5")
    assert state["result"]["effects"] == [{"name": "refractory_period"}]
    assert bench.control.diagnosis() == state
    assert bench.http.get("diagnosis/report").text == "<h1>what was found</h1>"

    assert bench.parameters() == before
    version = bench.control.accept_diagnosis()["parameters_version"]
    extended = bench.parameters()
    assert before["refractory_period"]["period_us"] != 300
    before_but = before | {"refractory_period": before["refractory_period"] | {"period_us": 300}}
    assert extended == before_but
    bench.holds_in_packets(version)
    assert "nothing to accept" in refusal(409, bench.control.accept_diagnosis)

    reverted = bench.control.revert_diagnosis()["parameters_version"]
    assert reverted == version + 1
    assert bench.parameters() == before
    bench.holds_in_packets(reverted)
    assert "nothing to revert" in refusal(409, bench.control.revert_diagnosis)
    assert bench.control.accept_diagnosis()["parameters_version"] == reverted + 1


def test_one_accepted_after_the_other_is_reverted_one_after_the_other(bench: Bench) -> None:
    start = bench.parameters()
    bench.started()
    bench.done("find")
    bench.control.accept_diagnosis()
    bench.control.set({"temperature_c": 50})
    warmer = bench.parameters()
    bench.started()
    bench.done("find")
    bench.control.accept_diagnosis()
    bench.control.revert_diagnosis()
    assert bench.parameters() == warmer
    bench.control.revert_diagnosis()
    assert bench.parameters() == start | {"temperature_c": 50}


def test_what_was_set_meanwhile_stays(bench: Bench) -> None:
    start = bench.parameters()
    bench.started()
    bench.control.set({"temperature_c": 40})
    bench.done("find")
    bench.control.accept_diagnosis()
    assert bench.parameters()["temperature_c"] == 40
    assert bench.parameters()["refractory_period"]["period_us"] == 300
    bench.control.set({"comparator.theta_on": 1.5})
    bench.control.revert_diagnosis()
    comparator = start["comparator"] | {"theta_on": 1.5}
    assert bench.parameters() == start | {"temperature_c": 40, "comparator": comparator}


def test_of_the_one_before_the_results_are_kept_and_no_more(bench: Bench) -> None:
    bench.started()
    folder = Path(bench.done("find")["folder"])
    (folder / "runs").mkdir()
    (folder / "runs" / "1.npy").touch()
    (folder / "gathered.npz").touch()
    bench.started()
    kept = {path.name for path in folder.iterdir()}
    assert kept == {"start.yaml", "running.log", "result.json", "camera.yaml", "report.html"}
    bench.done("none")


def test_there_is_one_at_a_time(bench: Bench) -> None:
    bench.started()
    assert "a diagnosis is running" in refusal(409, lambda: bench.control.start_diagnosis(bench.walk))
    assert "nothing to accept" in refusal(409, bench.control.accept_diagnosis)
    assert bench.http.get("diagnosis/report").status_code == 404
    assert bench.done("find")["state"] == "done"


@pytest.mark.parametrize("name", ["walk.npz", "stubborn.npz"])
def test_it_can_be_ended(bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setattr(diagnosis_module, "END_S", 0.3)
    assert "no diagnosis is running" in refusal(409, bench.control.end_diagnosis)
    (tmp_path / name).touch()
    process = bench.started(reference=tmp_path / name)
    assert bench.control.end_diagnosis()["state"] == "idle"
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)
    assert "no diagnosis is running" in refusal(409, bench.control.end_diagnosis)
    bench.started()
    assert bench.done("find")["state"] == "done"


@pytest.mark.parametrize(
    ("order", "line"),
    [
        ("refuse", "walk.npz has no frames: record some"),
        ("break", "the diagnosis failed: KeyError: 'k7': please report it, with "),
    ],
)
def test_a_process_that_fails_is_said_in_a_line(bench: Bench, order: str, line: str) -> None:
    bench.started()
    state = bench.done(order)
    assert state["state"] == "failed"
    assert state["error"].startswith(line)
    assert "\n" not in state["error"]
    assert "nothing to accept" in refusal(409, bench.control.accept_diagnosis)
    assert bench.emulator.failure is None


def test_where_nothing_is_missing_there_is_nothing_to_accept(bench: Bench) -> None:
    bench.started()
    assert bench.done("none")["result"]["verdict"] == "none"
    assert "nothing to accept" in refusal(409, bench.control.accept_diagnosis)


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({}, "give either reference, a recording's path, or stream"),
        ({"reference": "a.npz", "stream": "tcp://127.0.0.1:1"}, "give either reference"),
        ({"reference": "/none/such.npz"}, "/none/such.npz is not there"),
        ({"reference": "x" * 4000}, "is not there"),
        ({"reference": __file__}, "no recording has the suffix '.py'"),
        ({"stream": "robot:5560"}, "stream: String should match"),
        ({"reference": "a.npz", "seconds": 0}, "seconds: Input should be greater than 0"),
        ({"recording": "a.npz"}, "recording: there is no such key, only reference, stream, seconds"),
    ],
)
def test_what_cannot_be_diagnosed_is_refused(bench: Bench, body: dict[str, Any], words: str) -> None:
    response = bench.http.post("diagnosis", json=body)
    assert response.status_code == 422
    assert words in response.json()["detail"]
    assert bench.control.diagnosis()["state"] == "idle"


def test_two_cameras_are_gathered_on_one_clock(bench: Bench) -> None:
    began_us = time.time_ns() // 1000
    with publishing(SCENE, tiny(comparator={"theta_on": 0.5})) as (_, reference, url):
        bench.control.start_diagnosis(stream=url, seconds=1.2)
        shown = bench.pushed(lambda it: it["figures"] and it["figures"]["events"])
        assert shown["state"] == "gathering"
        waiting = bench.pushed(lambda it: it["progress"] and it["progress"][-1].startswith("process"))
        recording = read(Path(waiting["folder"]) / "gathered.npz")
        last_us = recording.events["t"][-1]
        reference.wait(lambda it: it.events["t"][-1] >= last_us)
        sent = reference.events
    assert waiting["figures"]["events"] == recording.events.size > 0
    first = np.flatnonzero(sent["t"] == recording.events["t"][0])[0]
    np.testing.assert_array_equal(recording.events, sent[first : first + recording.events.size])
    assert recording.frames is not None
    assert recording.frame_t_us is not None
    looked_at = {frame.t_us: frame.image for frame in bench.listener.frames}
    for image, t_us in zip(recording.frames, recording.frame_t_us.tolist(), strict=True):
        np.testing.assert_array_equal(image, looked_at[t_us])
    for t_us in (recording.frame_t_us, recording.events["t"]):
        assert began_us < t_us[0] < t_us[-1] < time.time_ns() // 1000
    overlap_us = min(recording.frame_t_us[-1], last_us) - max(
        recording.frame_t_us[0], recording.events["t"][0]
    )
    assert overlap_us > 0.5e6
    strata = waiting["figures"]["strata"]
    assert [one["from_dn"] for one in strata] == sorted(one["from_dn"] for one in strata)
    assert sum(one["reference"]["on"] for one in strata) > sum(one["here"]["on"] for one in strata) > 0
    assert bench.done("find")["state"] == "done"


def test_rates_are_counted_a_pixel_from_dark_to_bright() -> None:
    image = np.arange(64, dtype=np.uint8).reshape(8, 8)
    y, x = np.divmod(np.arange(64), 8)
    once = np.zeros(64, EVENT)
    once["x"], once["y"], once["p"] = x, y, np.arange(64) >= 32  # OFF of dark pixels, ON of bright ones
    sample = Sample(image)
    sample.count(0, once)
    sample.count(1, np.repeat(once, 3))
    strata = sample.tick()
    assert [(one.from_dn, one.to_dn) for one in strata] == [(0, 15), (16, 31), (32, 47), (48, 63)]
    for i, one in enumerate(strata):
        seen, unseen = (one.here.on, one.here.off) if i >= 2 else (one.here.off, one.here.on)
        three_times = one.reference.on if i >= 2 else one.reference.off
        assert (seen > 0, unseen) == (True, 0)
        assert three_times == pytest.approx(3 * seen, rel=1e-3)


def test_cameras_that_cannot_be_gathered(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def complaint(reference: str) -> str:
        assert main([bench.zmq, reference, str(tmp_path / "out.npz"), "1"]) == 1
        line = capfd.readouterr().err
        assert line.startswith("voltcam: ")
        assert line.count("\n") == 1
        assert not (tmp_path / "out.npz").exists()
        return line

    wide = Camera(name="wide", width=30, height=16)
    with publishing(SCENE, wide) as (_, _, url):
        assert f"the camera at {url} has 30x16 pixels, this one 24x16" in complaint(url)
    frames = moving_frames(200, tiny())
    clip = SourceRequest(uri=save_frames(tmp_path / "in.npz", frames), pace="fast", loop=True)
    with publishing(clip, tiny()) as (_, _, url):
        assert "off this host's clock: both cameras must look at something live" in complaint(url)
    monkeypatch.setattr(gather_module, "PATIENCE_S", 0.2)
    assert "nothing came from tcp://127.0.0.1:1 for 0.2 s" in complaint("tcp://127.0.0.1:1")


def test_the_daemons_end_ends_it(tmp_path: Path) -> None:
    fifo, walk = tmp_path / "orders", tmp_path / "walk.npz"
    os.mkfifo(fifo)
    walk.touch()
    command = [sys.executable, "-c", STUB, str(fifo)]
    diagnosis = Diagnosis(Emulator(tiny(), SCENE), "tcp://127.0.0.1:1", command=command, work=tmp_path)
    diagnosis.start(DiagnosisRequest(reference=str(walk)))
    until(lambda: diagnosis.state.progress, "the process is there")
    process = int(diagnosis.state.progress[0].split()[1])
    diagnosis.stop()
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)


@pytest.mark.skipif(not CHROMIUM.exists(), reason=f"no Chromium at {CHROMIUM}")
def test_the_page_starts_shows_accepts_and_reverts(bench: Bench) -> None:
    with sync_playwright() as playwright:
        page = playwright.chromium.launch(executable_path=CHROMIUM, args=CHROMIUM_ARGS).new_page()
        page.set_default_timeout(1000 * PATIENCE_S)
        expect.set_options(timeout=1000 * PATIENCE_S)
        errors: list[str] = []
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto(bench.control.url)
        reference, start = (
            page.get_by_label("Reference", exact=True),
            page.get_by_role("button", name="Start"),
        )
        expect(page.get_by_role("button", name="End")).to_be_hidden()
        reference.fill("/none/walk.npz")
        start.click()
        expect(page.locator("#diagnosis-error")).to_contain_text("/none/walk.npz is not there")
        reference.fill(str(bench.walk))
        start.click()
        expect(page.locator("#diagnosis-progress")).to_contain_text("priority 19")
        expect(page.locator("#diagnosis-error")).to_be_empty()
        expect(start).to_be_disabled()
        bench.order("find")
        expect(page.locator("#diagnosis-verdict")).to_have_text("This camera lacks a dead time.")
        expect(page.get_by_role("link", name="Report")).to_be_visible()
        page.get_by_role("button", name="Accept").click()
        page.get_by_role("button", name="Revert").click()
        expect(page.get_by_role("button", name="Accept")).to_be_visible()
        expect(page.get_by_role("button", name="Revert")).to_be_hidden()
        assert bench.control.parameters()["parameters_version"] == 2
        assert errors == []
