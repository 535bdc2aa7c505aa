"""The diagnosis beside a running camera: a real web server, a stub in place of the diagnosing process."""

import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import expect, sync_playwright

from voltcam_server.diagnosis import runner as runner_module
from voltcam_server.diagnosis.models import DiagnosisRequest
from voltcam_server.diagnosis.runner import DiagnosisRunner
from voltcam_server.emulator import Emulator

from ..page.browsing import CHROMIUM, CHROMIUM_ARGS
from ..rig import PATIENCE_S, SCENE, tiny, until
from .rig import STUB, Bench, diagnosing, refusal


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    with diagnosing(tmp_path) as bench:
        yield bench


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
    monkeypatch.setattr(runner_module, "END_S", 0.3)
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
        ({"reference": __file__}, "no recording has the suffix '.py'"),
        ({"stream": "robot:5560"}, "stream: give it like tcp://127.0.0.1:5561"),
        ({"reference": "a.npz", "seconds": 0}, "seconds: Input should be greater than 0"),
        ({"recording": "a.npz"}, "recording: there is no such key, only reference, stream, seconds"),
    ],
)
def test_what_cannot_be_diagnosed_is_refused(bench: Bench, body: dict[str, Any], words: str) -> None:
    response = bench.http.post("diagnosis", json=body)
    assert response.status_code == 422
    assert words in response.json()["detail"]
    assert bench.control.diagnosis()["state"] == "idle"


def test_the_daemons_end_ends_it(tmp_path: Path) -> None:
    fifo, walk = tmp_path / "orders", tmp_path / "walk.npz"
    os.mkfifo(fifo)
    walk.touch()
    command = [sys.executable, "-c", STUB, str(fifo)]
    diagnosis = DiagnosisRunner(Emulator(tiny(), SCENE), "tcp://127.0.0.1:1", command=command, work=tmp_path)
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
