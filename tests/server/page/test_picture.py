"""Pictures, views and figures on the page, in a real headless Chromium, at a real daemon."""

import base64
import json
import math
import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgpack
import numpy as np
import pytest
from playwright.sync_api import Page, WebSocketRoute, expect

from voltcam_client.packet import EVENT, Packet, encode_packet, pack_message

from .browsing import Daemon, needs_chromium, theta_box

COLOURS = """id => {
  const canvas = document.getElementById(id);
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  return new Set(new Uint32Array(data.buffer)).size;
}"""

pytestmark = needs_chromium


def picture(page: Page, canvas: str) -> str:
    return str(page.evaluate("id => document.getElementById(id).toDataURL()", canvas))


@pytest.mark.parametrize("canvas", ["events", "frame"])
def test_a_picture_is_there_and_moves(page: Page, canvas: str) -> None:
    page.wait_for_function(f"() => ({COLOURS})('{canvas}') > 10")
    before = picture(page, canvas)
    page.wait_for_function(
        "([id, before]) => document.getElementById(id).toDataURL() !== before", arg=[canvas, before]
    )


@pytest.fixture
def small(tmp_path: Path) -> Iterator[Daemon]:
    """So few events that a busy browser takes them all."""
    (tmp_path / "small.yaml").write_text("{name: small, width: 64, height: 48}")
    daemon = Daemon("--camera", "small.yaml", folder=tmp_path)
    yield daemon
    daemon.kill()


def test_the_rate_shown_is_the_daemons(page: Page, small: Daemon) -> None:
    page.goto(small.url)
    expect(page.locator("#rate-on")).not_to_have_text("0")
    expect(page.locator("#rate-off")).not_to_have_text("0")
    deadline = time.monotonic() + 20
    while True:
        shown = number(page.locator("#rate").inner_text())
        told = small.get("status")["events"]["per_s"]
        if shown == pytest.approx(told, rel=0.2):
            return
        assert time.monotonic() < deadline, f"the page shows {shown}/s, the daemon says {told}/s"
        page.wait_for_timeout(500)


def number(text: str) -> float:
    digits, _, prefix = text.partition(" ")
    return float(digits) * {"": 1, "k": 1e3, "M": 1e6}[prefix]


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
      const counts = picture.add(bytes.slice(used), header);
      const at = (x, y) => [picture.activity[y * 346 + x], picture.polarity[y * 346 + x]];
      return [counts, at(0, 0), at(345, 259), at(17, 3), picture.activity.reduce((a, b) => a + b)];
    }"""
    found = page.evaluate(script, base64.b64encode(message_of(events, 0)).decode())
    faded = math.exp(-3 / 33_000)  # the first of two at one pixel, 3 us later, in a window of 33 ms
    assert found[0] == [2, 2]
    assert [polarity for _, polarity in found[1:4]] == [1, 1, 0]
    assert [level for level, _ in found[1:4]] == pytest.approx([1, 1 + faded, 1], rel=1e-7)
    assert found[4] == pytest.approx(3 + faded, rel=1e-7)


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
          view.draw(10);
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


def test_events_fade_on_the_cameras_clock(page: Page) -> None:
    """One that waits, or sends in bursts, keeps its picture. One that begins anew has another."""
    events = np.array([(1_000_000, 1, 0, True)], EVENT)
    times_us = [1_000_000, 1_033_000, 500_000]  # the last of another time line
    packets = [
        Packet(events=events[:count], height=4, width=8, seq=0, time_base_ns=1000 * t_us, stamp_ns=0)
        for count, t_us in zip((1, 0, 0), times_us, strict=True)
    ]
    script = """async messages => {
      const { decode } = await import("./msgpack.js");
      const { EventPicture } = await import("./pictures.js");
      const view = new EventPicture(document.createElement("canvas"));
      view.paint([255, 255, 255], [0, 0, 200], [200, 0, 0]);
      const seen = [];
      for (const message of messages) {
        const bytes = Uint8Array.from(atob(message), (letter) => letter.charCodeAt(0)).buffer;
        const [header, used] = decode(bytes);
        view.fit(header);
        view.add(bytes.slice(used), header);
        for (let times = 0; times < 2; times++) {
          view.draw(33);
          seen.push(view.context.getImageData(1, 0, 1, 1).data[0]);
        }
      }
      return seen;
    }"""
    seen = page.evaluate(
        script, [base64.b64encode(pack_message(*encode_packet(each))).decode() for each in packets]
    )
    fresh, faded = (255 * math.exp(-level) for level in (1, math.exp(-1)))
    assert seen == pytest.approx([fresh, fresh, faded, faded, 255, 255], abs=2)


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


def test_on_a_phone_the_picture_stays_in_sight(page: Page) -> None:
    page.set_viewport_size({"width": 390, "height": 844})
    theta_box(page).scroll_into_view_if_needed()
    expect(page.locator("#events")).to_be_in_viewport(ratio=0.9)
    expect(theta_box(page)).to_be_in_viewport()
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
