"""The page, in a real headless Chromium, at a real daemon."""

import base64
import json
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import msgpack
import numpy as np
import pytest
from playwright.sync_api import Browser, Page, Response, WebSocketRoute, expect, sync_playwright
from tests.ports import free_port

from voltcam_client.packet import EVENT, Packet, encode_packet, pack_message

from .rig import until

CHROMIUM = Path("/usr/bin/chromium")
CHROMIUM_ARGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"]
CHROMIUM_ARGS += ["--disable-background-networking", "--disable-component-update", "--disable-sync"]
# Chromium's own, of an answer that says no and of a daemon that is not there.
NETWORK_COMPLAINTS = ("Failed to load resource", "WebSocket connection to")
START_S = 60
COLOURS = """id => {
  const canvas = document.getElementById(id);
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  return new Set(new Uint32Array(data.buffer)).size;
}"""

pytestmark = pytest.mark.skipif(not CHROMIUM.exists(), reason=f"no Chromium at {CHROMIUM}")


class Daemon:
    """`voltcam serve` on ports of its own, which stay the same over a restart."""

    def __init__(self, *arguments: str, folder: Path | None = None) -> None:
        self.http, self.zmq = (f"127.0.0.1:{free_port()}" for _ in range(2))
        self.url = f"http://{self.http}/"
        self.arguments = arguments or ("--zmq", f"tcp://{self.zmq}")
        self.folder = folder or Path()
        self.start()

    def start(self) -> None:
        command = [str(Path(sys.executable).with_name("voltcam")), "serve"]
        command += ["--http", self.http, *self.arguments]
        self.process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=self.folder
        )
        deadline = time.monotonic() + START_S
        while not self.ready():
            assert self.process.poll() is None, "the daemon ended"
            assert time.monotonic() < deadline, "the daemon is not ready"
            time.sleep(0.1)

    def ready(self) -> bool:
        try:
            return httpx.get(self.url + "readyz").is_success
        except httpx.TransportError:
            return False

    def kill(self) -> None:
        self.process.kill()
        self.process.wait()

    def get(self, path: str) -> Any:
        return httpx.get(f"{self.url}api/v1/{path}").raise_for_status().json()

    def patch(self, change: dict[str, Any]) -> httpx.Response:
        return httpx.patch(f"{self.url}api/v1/parameters", json=change)

    def theta_on(self) -> float:
        return float(self.get("parameters")["parameters"]["comparator"]["theta_on"])


@pytest.fixture(scope="module")
def daemon(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Daemon]:
    daemon = Daemon(folder=tmp_path_factory.mktemp("daemon"))
    yield daemon
    daemon.kill()


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    expect.set_options(timeout=15_000)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=CHROMIUM_ARGS)
        yield browser
        browser.close()


@pytest.fixture
def page(browser: Browser, daemon: Daemon) -> Iterator[Page]:
    """The page with the daemon's parameters on it; at the end it must not have complained on the console."""
    complaints: list[str] = []
    page = browser.new_page(viewport={"width": 1360, "height": 860})
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda message: complaints.append(message.text) if message.type == "error" else None)
    page.goto(daemon.url)
    expect(theta_box(page)).not_to_have_value("")
    yield page
    page.close()
    assert [text for text in complaints if not text.startswith(NETWORK_COMPLAINTS)] == []


def theta_box(page: Page) -> Any:
    return page.locator("[id='p-comparator.theta_on']")


def theta_slider(page: Page) -> Any:
    return page.get_by_role("slider", name="comparator.theta_on")


def theta_error(page: Page) -> Any:
    return page.locator("[id='p-comparator.theta_on-error']")


def is_patch(response: Response) -> bool:
    return response.request.method == "PATCH"


def picture(page: Page, canvas: str) -> str:
    return str(page.evaluate("id => document.getElementById(id).toDataURL()", canvas))


@pytest.mark.parametrize("canvas", ["events", "frame"])
def test_a_picture_is_there_and_moves(page: Page, canvas: str) -> None:
    page.wait_for_function(f"() => ({COLOURS})('{canvas}') > 10")
    before = picture(page, canvas)
    page.wait_for_function(
        "([id, before]) => document.getElementById(id).toDataURL() !== before", arg=[canvas, before]
    )


def test_the_rate_shown_is_the_daemons(page: Page, daemon: Daemon) -> None:
    expect(page.locator("#rate-on")).not_to_have_text("0")
    expect(page.locator("#rate-off")).not_to_have_text("0")
    deadline = time.monotonic() + 20
    while True:
        shown = number(page.locator("#rate").inner_text())
        told = daemon.get("status")["events"]["per_s"]
        if shown == pytest.approx(told, rel=0.2):
            return
        assert time.monotonic() < deadline, f"the page shows {shown}/s, the daemon says {told}/s"
        page.wait_for_timeout(500)


def number(text: str) -> float:
    digits, _, prefix = text.partition(" ")
    return float(digits) * {"": 1, "k": 1e3, "M": 1e6}[prefix]


def test_a_slider_turns_a_parameter_and_the_reset_button_turns_it_back(page: Page, daemon: Daemon) -> None:
    reset = page.get_by_role("button", name="set comparator.theta_on back to the camera's value, 1")
    expect(reset).to_be_hidden()
    with page.expect_response(is_patch) as answer:
        theta_slider(page).fill("230")  # a little right of the middle, where steps are fine
    assert answer.value.ok
    expect(theta_box(page)).to_have_value("1.2")
    assert daemon.theta_on() == 1.2
    version = daemon.get("status")["parameters_version"]
    expect(page.locator("#version")).to_have_text(str(version))
    reset.click()
    expect(theta_box(page)).to_have_value("1")
    expect(reset).to_be_hidden()
    assert daemon.theta_on() == 1


@pytest.mark.parametrize("given", ["1000", "-1", "much", "Infinity"])
def test_an_invalid_value_is_explained_and_changes_nothing(page: Page, daemon: Daemon, given: str) -> None:
    before = daemon.get("parameters")
    theta_box(page).press("Control+a")
    theta_box(page).press_sequentially(given)
    theta_box(page).press("Enter")
    refused = daemon.patch({"comparator": {"theta_on": json.loads(given) if given[-1].isdigit() else given}})
    expect(theta_error(page)).to_have_text(f"Not applied. {refused.json()['detail']}")
    expect(theta_box(page)).to_have_value("1")
    assert daemon.get("parameters") == before
    theta_box(page).fill("1.5")
    with page.expect_response(is_patch):
        theta_box(page).press("Enter")
    expect(theta_error(page)).to_be_empty()
    daemon.patch({"comparator": {"theta_on": 1}})


def test_a_choice_is_a_parameter_too(page: Page, daemon: Daemon) -> None:
    with page.expect_response(is_patch):
        page.locator("[id='p-contrast_response.response']").select_option("linearised")
    expect(page.locator("#version")).to_have_text(str(daemon.get("status")["parameters_version"]))
    assert daemon.get("parameters")["parameters"]["contrast_response"]["response"] == "linearised"
    daemon.patch({"contrast_response": {"response": "logarithmic"}})
    expect(page.locator("[id='p-contrast_response.response']")).to_have_value("logarithmic")


def test_a_change_made_elsewhere_appears(page: Page, daemon: Daemon) -> None:
    daemon.patch({"temperature_c": 61.5})
    expect(page.locator("[id='p-temperature_c']")).to_have_value("61.5")
    daemon.patch({"temperature_c": 25})


def test_every_parameter_of_the_schema_has_a_field(page: Page, daemon: Daemon) -> None:
    for folded in page.locator(".group:not([open]) > summary").all()[::-1]:
        folded.click()
    for effect, values in daemon.get("parameters")["parameters"].items():
        names = [f"{effect}.{name}" for name in values] if isinstance(values, dict) else [effect]
        for name in names:
            expect(page.locator(f"[id='p-{name}']")).to_be_visible()


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
    expect(page.locator("#banner")).to_be_hidden()


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


def test_a_daemon_that_dies_is_announced_and_found_again(page: Page, daemon: Daemon) -> None:
    expect(page.locator("#banner")).to_be_hidden()
    daemon.kill()
    expect(page.locator("#banner-words")).to_have_text("The daemon does not answer. Trying again…")
    expect(page.locator("#rate")).to_have_text("0")
    daemon.start()
    expect(page.locator("#banner-words")).not_to_contain_text(
        "does not answer"
    )  # it may be overloaded at first
    expect(page.locator("#rate")).not_to_have_text("0")


def test_a_hidden_page_takes_no_stream(page: Page, daemon: Daemon) -> None:
    expect(page.locator("#rate")).not_to_have_text("0")
    set_hidden = """hidden => {
      Object.defineProperty(document, "hidden", { value: hidden, configurable: true });
      document.dispatchEvent(new Event("visibilitychange"));
    }"""
    page.evaluate(set_hidden, True)
    expect(page.locator("#rate")).to_have_text("0")
    assert daemon.get("status")["transports"]["websocket"]["clients"] == []
    page.evaluate(set_hidden, False)
    expect(page.locator("#rate")).not_to_have_text("0")


def test_packets_that_are_missing_are_counted(page: Page) -> None:
    def send(stream: WebSocketRoute) -> None:
        for seq in (7, 8, 11, 12):
            message = message_of(np.zeros(1, EVENT), seq)
            stream.send(len(message).to_bytes(4, "little") + message)

    page.route_web_socket("**/events?*", send)
    page.reload()
    expect(page.locator("#counts > div", has_text="packets lost").locator("dd")).to_have_text("2")


def message_of(events: Any, seq: int) -> bytes:
    packet = Packet(events=events, height=260, width=346, seq=seq, time_base_ns=0, stamp_ns=0)
    return pack_message(*encode_packet(packet))


def test_events_land_on_their_pixels(page: Page) -> None:
    events = np.array([(5, 0, 0, True), (6, 345, 259, False), (9, 345, 259, True), (12, 17, 3, False)], EVENT)
    script = """async message => {
      const { decode } = await import("./msgpack.js");
      const { EventPicture } = await import("./pictures.js");
      const bytes = Uint8Array.from(atob(message), (letter) => letter.charCodeAt(0)).buffer;
      const [header, used] = decode(bytes);
      const picture = new EventPicture(document.createElement("canvas"));
      picture.fit(header);
      const counts = picture.add(bytes.slice(used));
      const at = (x, y) => [picture.activity[y * 346 + x], picture.polarity[y * 346 + x]];
      return [counts, at(0, 0), at(345, 259), at(17, 3), picture.activity.reduce((a, b) => a + b)];
    }"""
    found = page.evaluate(script, base64.b64encode(message_of(events, 0)).decode())
    assert found == [[2, 2], [1, 1], [2, 1], [1, 0], 4]


def test_msgpack_reads_what_pythons_writes(page: Page) -> None:
    integers = [s * (2**n + d) for n in (0, 5, 7, 8, 15, 16, 31, 32, 52) for d in (-1, 0, 1) for s in (-1, 1)]
    texts = ["µ" * n for n in (0, 15, 16, 200, 40_000)]
    shapes = [{str(i): i for i in range(n)} for n in (0, 15, 16, 70_000)] + [[None] * 16, [True] * 70_000]
    value = [integers, texts, shapes, 0.1, -1e300, False, {"deep": [{"er": {}}]}]
    script = """async bytes => {
      const { decode } = await import("./msgpack.js");
      const all = Uint8Array.from(atob(bytes), (letter) => letter.charCodeAt(0));
      const [value, used] = decode(all.buffer);
      return [JSON.stringify(value, (_, each) => (typeof each === "bigint" ? String(each) : each)), used];
    }"""
    for packed, wanted in ((value, value), ([2**64 - 1, -(2**63)], [str(2**64 - 1), str(-(2**63))])):
        data = bytes(msgpack.packb(packed) or b"")
        read, used = page.evaluate(script, base64.b64encode(data + b"rest").decode())
        assert (json.loads(read), used) == (wanted, len(data))


@pytest.mark.parametrize("view", ["surface", "histogram", "cloud", "fade"])
def test_there_are_several_ways_to_look(page: Page, view: str) -> None:
    page.locator("#view").select_option(view)
    page.wait_for_function(f"() => ({COLOURS})('events') > 10")
    before = picture(page, "events")
    page.wait_for_function("before => document.getElementById('events').toDataURL() !== before", arg=before)
    colours = "document.getElementById('events').getContext('2d').getImageData(0, 0, 99, 99).data"
    assert page.evaluate(f"{colours}.every((byte, i) => i % 4 < 3 || byte === 255)")  # nothing see-through


def test_views_show_what_their_names_say(page: Page) -> None:
    """Two ON events at (1, 0), an older OFF at (2, 0), nothing at (3, 3); on a sensor of 8 x 4."""
    events = np.array([(1000, 2, 0, False), (20_000, 1, 0, True), (21_000, 1, 0, True)], EVENT)
    events["t"] += 10**15
    packet = Packet(events=events, height=4, width=8, seq=0, time_base_ns=10**18, stamp_ns=0)
    later = Packet(events=events[:0], height=4, width=8, seq=1, time_base_ns=10**18 + 10**9, stamp_ns=0)
    script = """async messages => {
      const { decode } = await import("./msgpack.js");
      const { Histogram, TimeSurface } = await import("./views.js");
      const { baseUs } = await import("./events.js");
      const seen = {};
      for (const [name, View] of Object.entries({ Histogram, TimeSurface })) {
        const canvas = document.createElement("canvas");
        const view = new View(canvas);
        view.paint([255, 255, 255], [0, 0, 200], [200, 0, 0]);
        view.windowMs = 100;
        for (const message of messages) {
          const bytes = Uint8Array.from(atob(message), (letter) => letter.charCodeAt(0)).buffer;
          const [header, used] = decode(bytes);
          view.fit(header);
          view.add(bytes.slice(used), header);
          if (name === "TimeSurface" && message === messages[0]) view.newest = baseUs(header) + 21000;
          view.draw(16, 10);
          if (name === "TimeSurface") break;
        }
        const at = (x, y) => [...view.context.getImageData(x, y, 1, 1).data].slice(0, 3);
        seen[name] = [at(1, 0), at(2, 0), at(3, 3)];
      }
      return seen;
    }"""
    messages = [base64.b64encode(pack_message(*encode_packet(each))).decode() for each in (packet, later)]
    seen = page.evaluate(script, messages)
    assert seen["TimeSurface"][0][2] > 190
    assert seen["TimeSurface"][1][0] > 200 > seen["TimeSurface"][0][0] + 150  # two windows old: faint
    assert seen["Histogram"] == [[0, 0, 200], [228, 131, 131], [255, 255, 255]]


def test_a_pause_holds_the_picture_and_not_the_camera(page: Page) -> None:
    page.wait_for_function(f"() => ({COLOURS})('events') > 10")
    page.keyboard.press(" ")
    expect(page.locator("#pause")).to_have_text("Go on")
    before = picture(page, "events")
    page.wait_for_timeout(500)
    assert picture(page, "events") == before
    expect(page.locator("#rate")).not_to_have_text("0")
    page.locator("#pause").click()
    page.wait_for_function("before => document.getElementById('events').toDataURL() !== before", arg=before)


def test_a_pixel_is_looked_at(page: Page) -> None:
    page.locator("#events").click(position={"x": 200, "y": 150})
    expect(page.locator("#pixel-about")).to_have_text(re.compile(r"\(\d+, \d+\)"))
    expect(page.locator("#frame-figure")).to_be_hidden()
    page.wait_for_function(f"() => ({COLOURS})('pixel') > 5")
    page.locator("#pixel-close").click()
    expect(page.locator("#frame-figure")).to_be_visible()


def test_an_effect_is_switched_off_and_on_again(page: Page, daemon: Daemon) -> None:
    switch = page.get_by_role("switch", name="threshold_mismatch on")
    expect(switch).to_be_checked()
    before = daemon.get("parameters")["parameters"]["threshold_mismatch"]
    with page.expect_response(is_patch):
        switch.click()
    expect(switch).not_to_be_checked()
    assert daemon.get("parameters")["parameters"]["threshold_mismatch"] == {"sigma": 0}
    with page.expect_response(is_patch):
        switch.click()
    assert daemon.get("parameters")["parameters"]["threshold_mismatch"] == before
    flicker = page.get_by_role("switch", name="flicker on")  # of the light; no camera has it on
    expect(flicker).to_be_disabled()


def test_parameters_are_searched(page: Page) -> None:
    page.keyboard.press("/")
    page.keyboard.type("latency jitter")
    expect(page.locator("[id='p-latency.jitter_us']")).to_be_visible()
    expect(theta_box(page)).to_be_hidden()
    page.locator("#search").fill("")
    expect(theta_box(page)).to_be_visible()


def test_presets_and_files(page: Page, daemon: Daemon, tmp_path: Path) -> None:
    before = daemon.get("parameters")["parameters"]
    with page.expect_download() as saving:
        page.locator("#save").click()
    saving.value.save_as(tmp_path / "mine.yaml")
    page.locator("#preset").select_option("noisy")
    page.wait_for_function("() => document.getElementById('version').textContent > 0")
    assert daemon.get("parameters")["parameters"] == daemon.get("presets")["noisy"]
    with page.expect_response("**/parameters/file"):
        page.locator("#load").set_input_files(tmp_path / "mine.yaml")
    assert daemon.get("parameters")["parameters"] == before
    (tmp_path / "bad.yaml").write_text("shutter: 1")
    page.locator("#load").set_input_files(tmp_path / "bad.yaml")
    expect(page.locator("#preset-error")).to_contain_text("no such key")


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


def test_a_recording_that_has_ended_is_played_again(page: Page, daemon: Daemon) -> None:
    frames = np.full((40, 260, 346), 90, np.uint8)
    np.savez(daemon.folder / "short.npz", frames=frames, t_us=20_000 * np.arange(40))
    page.locator("#source-uri").fill("short.npz")
    page.get_by_role("button", name="Switch").click()
    expect(page.locator("#banner-words")).to_contain_text("Ended")
    expect(page.locator("#source-position")).to_contain_text("of 0.8 s")
    page.get_by_role("button", name="Play in a loop").click()
    expect(page.locator("#banner")).to_be_hidden()
    assert daemon.get("source")["request"]["loop"]
    page.locator("#source-place").fill("0.5")
    page.wait_for_function("() => document.getElementById('source-error').textContent === ''")
    assert daemon.get("source")["request"]["start_s"] == 0.5
    httpx.put(f"{daemon.url}api/v1/source", json={"uri": "scene"}).raise_for_status()


def test_on_a_phone_the_picture_stays_in_sight(page: Page) -> None:
    page.set_viewport_size({"width": 390, "height": 844})
    theta_box(page).scroll_into_view_if_needed()
    expect(page.locator("#events")).to_be_in_viewport(ratio=0.9)
    expect(theta_box(page)).to_be_in_viewport()
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_several_cameras_are_chosen_from(browser: Browser, tmp_path: Path) -> None:
    ports = [free_port() for _ in range(2)]
    config = tmp_path / "rig.yaml"
    zmq = [f"{{zmq: 'tcp://127.0.0.1:{port}'}}" for port in ports]
    config.write_text(f"cameras: {{left: {zmq[0]}, right: {zmq[1]}}}")
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
