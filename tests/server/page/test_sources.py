"""Sources, recordings and daemons as the page has them: switched, away, locked, several."""

from pathlib import Path

import httpx
import numpy as np
import pytest
from playwright.sync_api import Browser, Locator, Page, expect
from tests.ports import free_port

from ..rig import until
from .browsing import Daemon, is_patch, needs_chromium, theta_box

pytestmark = needs_chromium


def banner(page: Page, words: str) -> Locator:
    """The banner where it says this: a busy machine may keep it up for another reason."""
    return page.locator("#banner", has_text=words)


def test_a_source_that_cannot_be_is_explained(page: Page, daemon: Daemon) -> None:
    page.get_by_label("Source", exact=True).fill("/no/such/clip.mp4")
    page.get_by_role("button", name="Switch").click()
    expect(page.locator("#source-error")).to_contain_text("/no/such/clip.mp4")
    assert daemon.get("source")["state"] == "running"


def test_a_new_source_keeps_how_the_former_was_read(page: Page, daemon: Daemon) -> None:
    httpx.put(
        f"{daemon.url}api/v1/source", json={"uri": "scene", "fit": "letterbox", "fps": 30}
    ).raise_for_status()
    page.reload()
    expect(page.locator("#rate")).not_to_have_text("0")
    with page.expect_response("**/source") as answer:
        page.get_by_role("button", name="Switch").click()
    assert answer.value.ok
    expect(page.locator("#source-error")).to_be_empty()
    request = daemon.get("source")["request"]
    assert (request["uri"], request["fit"], request["fps"]) == ("scene", "letterbox", 30)


def test_a_source_that_is_away_is_announced(page: Page, daemon: Daemon) -> None:
    status = daemon.get("status")
    status |= {"state": "source lost", "reason": "/dev/video0 is gone: plug it in"}
    page.route("**/status", lambda route: route.fulfill(json=status))
    expect(page.locator("#banner-words")).to_have_text("Source lost: /dev/video0 is gone: plug it in")
    page.unroute("**/status")
    expect(banner(page, "Source lost")).to_be_hidden()


def test_a_recording_that_has_ended_is_played_again(page: Page, daemon: Daemon) -> None:
    frames = np.full((40, 260, 346), 90, np.uint8)
    np.savez(daemon.folder / "short.npz", frames=frames, t_us=20_000 * np.arange(40))
    page.locator("#source-uri").fill("short.npz")
    page.get_by_role("button", name="Switch").click()
    expect(page.locator("#banner-words")).to_contain_text("Ended")
    expect(page.locator("#source-position")).to_contain_text("of 0.8 s")
    page.get_by_role("button", name="Play in a loop").click()
    expect(banner(page, "Ended")).to_be_hidden()
    assert daemon.get("source")["request"]["loop"]
    page.locator("#source-place").fill("0.5")
    until(lambda: daemon.get("source")["request"]["start_s"] == 0.5, "it begins there")
    expect(page.locator("#source-error")).to_have_text("")
    httpx.put(f"{daemon.url}api/v1/source", json={"uri": "scene"}).raise_for_status()


def test_recordings_are_begun_and_ended(page: Page, daemon: Daemon) -> None:
    path = page.locator("#record-path")
    path.fill("../away.npz")
    page.locator("#record-button").click()
    expect(page.locator("#record-error")).to_contain_text("outside")
    path.fill("page.npz")
    page.locator("#record-button").click()
    expect(page.locator("#record-button")).to_have_text("Stop")
    expect(page.locator("#record-about")).to_contain_text("page.npz")
    page.wait_for_timeout(500)
    page.locator("#record-button").click()
    expect(page.locator("#record-button")).to_have_text("Record")
    until((daemon.folder / "page.npz").exists, "the recording is there")


def test_a_daemon_that_dies_is_announced_and_found_again(page: Page, daemon: Daemon) -> None:
    expect(banner(page, "does not answer")).to_be_hidden()
    daemon.kill()
    expect(page.locator("#banner-words")).to_have_text("The daemon does not answer. Trying again…")
    expect(page.locator("#rate")).to_have_text("0")
    daemon.start()
    expect(page.locator("#banner-words")).not_to_contain_text(
        "does not answer"
    )  # it may be overloaded at first
    expect(page.locator("#rate")).not_to_have_text("0")


def test_a_daemon_with_tokens_asks_for_one(browser: Browser, monkeypatch: pytest.MonkeyPatch) -> None:
    token = "t" * 32
    monkeypatch.setenv("VOLTCAM_TOKEN", token)
    locked = Daemon()
    page = browser.new_page()
    try:
        page.goto(locked.url)
        page.get_by_label("This camera asks for a token").fill("no token at all")
        page.get_by_role("button", name="Open").click()
        expect(page.locator("#session-error")).to_contain_text("not known")
        page.get_by_label("This camera asks for a token").fill(token)
        page.get_by_role("button", name="Open").click()
        expect(page.locator("#rate")).not_to_have_text("0")
        expect(page.locator("#session")).to_be_hidden()
    finally:
        page.close()
        locked.kill()


def test_several_cameras_are_chosen_from(browser: Browser, tmp_path: Path) -> None:
    ports = [free_port() for _ in range(2)]
    config = tmp_path / "rig.yaml"
    zmq = [f"{{zmq: 'tcp://127.0.0.1:{port}'}}" for port in ports]
    config.write_text(f"camera: typical\ncameras: {{left: {zmq[0]}, right: {zmq[1]}}}")
    rig = Daemon("--config", str(config))
    page = browser.new_page()
    try:
        page.goto(rig.url)
        expect(page.locator("#camera")).to_contain_text("left")
        page.locator("#cameras").select_option("right")
        expect(page.locator("#camera")).to_contain_text("right")
        expect(page.locator("#rate")).not_to_have_text("0")
        with page.expect_response(is_patch):
            theta_box(page).fill("3")
            theta_box(page).press("Enter")
        of = {name: rig.get(f"parameters?camera={name}")["parameters"] for name in ("left", "right")}
        assert (of["left"]["comparator"]["theta_on"], of["right"]["comparator"]["theta_on"]) == (1, 3)
    finally:
        page.close()
        rig.kill()
