"""What runs in the guest: `python -m tests.v4l2.guest CAMERA_FILE`.

A line of JSON on the second serial line for each thing that was tried, {"what", "held", "saw"}, and at the
end {"end": true}.
"""

import json
import os
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from tests.campaigns.daemon import Daemon, until

from . import vivid
from .listener import Listener
from .settings import FPS, HEIGHT, LONG_S, MEMORY_BYTES, WIDTH

SAID = Path("/dev/ttyS1")
FIRST, SECOND = "/dev/video0", "/dev/video1"
LOST_S = 15.0  # the source's own limit without a frame is 5 s
LOOK_S = 3.0


def main(camera: str) -> None:
    os.environ["VOLTCAM_ACCESS__SOURCE_DEVICES"] = json.dumps(["/dev/video*", "/dev/v4l/*"])
    vivid.load()
    vivid.stamp_at_exposure(FIRST)
    vivid.draw(FIRST, vivid.FAST)
    _say("the kernel made two cameras", Path(FIRST).exists() and Path(SECOND).exists(), _uptime_s())
    asked = ["--width", str(WIDTH), "--height", str(HEIGHT), "--fps", str(FPS), "--pixel-format", "YUYV"]
    packets = ["--burst"]  # one a frame: this processor is slow
    source = ["--source", FIRST, "--camera", camera, *packets, *asked]
    kept = _kernels()
    with Daemon(*source, memory_bytes=MEMORY_BYTES) as daemon:
        _say("the daemon started", True, _uptime_s())
        with Listener(daemon.get("camera")["zmq"]) as listener:
            for what, held, saw in _tried(daemon, listener):
                _say(what, held, saw)
        code, end_s, errors = daemon.end()
        made = sorted(_kernels() - kept)  # they took the time of some of the waits
        saw = f"status {code} in {end_s:.1f} s {errors}; {len(made)} kernels were compiled here: {made}"
        _say("ended in good order", (code, errors) == (0, ""), saw)
    SAID.open("w").write(json.dumps({"end": True}) + "\n")


Tried = Iterator[tuple[str, bool, object]]


def _tried(daemon: Daemon, listener: Listener) -> Tried:
    yield from _streams(daemon, listener)
    yield from _unplugged(daemon, listener)
    yield from _loose_contact(daemon, listener)
    yield from _busy(daemon)
    yield from _by_index(daemon)
    order = [listener.backwards, listener.lost_packets, listener.restarts, listener.error]
    yield "one subscription saw time go on, and no packet lost", order == [0, 0, 0, None], order


def _streams(daemon: Daemon, listener: Listener) -> Tried:
    came_s = until(lambda: listener.events > 0, LONG_S)
    yield "events come where bars move", came_s < LONG_S, f"after {came_s:.1f} s"
    received = daemon.get("status")["frames"]["received"]
    began_s, began_events = time.monotonic(), listener.events
    time.sleep(2 * LOOK_S)
    status = daemon.get("status")
    fps = (status["frames"]["received"] - received) / (time.monotonic() - began_s)
    yield "frames come at the rate asked for", 0.6 * FPS < fps < 1.2 * FPS, f"{fps:.2f} 1/s"
    yield "many events while bars move", (moved := listener.events - began_events) > 1000, moved
    granted = status["source"]["granted"]
    fields = [granted[key] for key in ("kind", "width", "height", "fps", "pixel_format", "backend", "clock")]
    expected = ["device", WIDTH, HEIGHT, FPS, "YUYV", "V4L2", "kernel"]
    yield "the format is what was asked for", fields == expected, fields
    said = vivid.format_of(FIRST)
    same = all(part in said for part in (f"{WIDTH}/{HEIGHT}", "'YUYV'", f"{FPS}.000"))
    yield "the driver says the same", same, said if not same else ""
    behind_s = time.time() - listener.last_us / 1e6
    yield "stamps are on the wall clock", 0 <= behind_s < LOST_S, f"{behind_s:.3f} s"
    vivid.draw(FIRST, vivid.STILL)
    still_s = until(lambda: _quiet(listener), LONG_S)
    yield "no events while bars stand", still_s < LONG_S, f"after {still_s:.1f} s"
    vivid.draw(FIRST, vivid.FAST)


def _unplugged(daemon: Daemon, listener: Listener) -> Tried:
    """The device goes while it is held, then the module; both come again, and so does the stream."""
    yield "in use, the module stays", not vivid.unload(), ""
    vivid.unbind()
    lost_s, source = _lost(daemon)
    yield "unplugged: /status says so", "unplugged; plug it in again" in source["message"], source["message"]
    yield "soon", lost_s < LOST_S, f"{lost_s:.1f} s"
    let_go_s = until(vivid.unload, LOST_S)
    yield "nothing is held any more: the module goes", let_go_s < LOST_S, f"{let_go_s:.1f} s"
    time.sleep(2)
    yield "still running, and it says what is missing", *_word(daemon)
    yield from _again(daemon, listener, "plugged in again: the stream is back", vivid.load)


def _loose_contact(daemon: Daemon, listener: Listener) -> Tried:
    vivid.disconnect(FIRST)
    lost_s, source = _lost(daemon)
    held = lost_s < LOST_S and "unplugged; plug it in again" in source["message"]
    yield "disconnected: /status says so", held, f"{lost_s:.1f} s: {source['message']}"
    yield from _again(daemon, listener, "let go, the driver has it back, and so has the stream", lambda: None)


def _busy(daemon: Daemon) -> Tried:
    """The second camera is taken by another program: a change to it is refused, the first one goes on."""
    busy = vivid.streaming(SECOND)
    try:
        answer = daemon.http.put("source", json={"uri": SECOND})
    finally:
        busy.kill()
        busy.wait(10)
    yield "busy is refused in a line", not answer.is_success and "another program" in answer.text, answer.text
    back_s = until(lambda: daemon.get("status")["state"] == "running", LONG_S)
    yield "the first one runs on", back_s < LONG_S, f"{back_s:.1f} s"


def _by_index(daemon: Daemon) -> Tried:
    """The second node, by a name as udev gives, and by its number, as it comes."""
    name = Path("/dev/v4l/by-id/usb-camera")
    name.parent.mkdir(parents=True)
    name.symlink_to(SECOND)
    answer = daemon.http.put("source", json={"uri": str(name)})
    yield "the second node by another name", answer.is_success, answer.text[:80]
    answer = daemon.http.put("source", json={"uri": "1"})
    yield "the second node by its index", answer.is_success, answer.text[:300]
    went_s = until(lambda: daemon.get("status")["state"] == "running", LONG_S)
    granted = daemon.get("status")["source"]["granted"]
    yield "it runs", went_s < LONG_S and granted["width"] > 0, granted


def _quiet(listener: Listener) -> bool:
    """Whether packets come for a while and none of them holds an event."""
    events, packets = listener.events, listener.packets
    time.sleep(LOOK_S)
    return listener.events == events and listener.packets > packets


def _lost(daemon: Daemon) -> tuple[float, dict[str, Any]]:
    seconds = until(lambda: daemon.get("status")["state"] == "source lost", LONG_S)
    return seconds, daemon.get("status")["source"]


def _word(daemon: Daemon) -> tuple[bool, str]:
    status = daemon.get("status")
    missing = "no such device" in status["reason"] or "unplugged" in status["reason"]
    return status["state"] == "source lost" and missing, status["reason"]


def _again(daemon: Daemon, listener: Listener, what: str, plug: Callable[[], None]) -> Tried:
    listener.gap_us = (0, 0)
    lost_us = time.time_ns() // 1000
    plug()
    back_s = until(lambda: daemon.get("status")["state"] == "running", LONG_S)
    if back_s < LONG_S:
        vivid.draw(FIRST, vivid.FAST)
    yield what, back_s < LONG_S, f"{back_s:.1f} s"
    granted = daemon.get("status")["source"]["granted"]
    yield "the format is asked for again", (granted["width"], granted["fps"]) == (WIDTH, FPS), granted
    back_us = time.time_ns() // 1000  # events from before the loss may still be on their way
    came_s = until(lambda: listener.last_us > back_us, LONG_S)
    yield "its events, too, at the same subscriber", came_s < LONG_S, f"{came_s:.1f} s"
    began_us, ended_us = listener.gap_us
    none = 0 < began_us <= lost_us < ended_us
    yield "no events of the time between", none, f"{(ended_us - began_us) / 1e6:.1f} s"


def _say(what: str, held: bool, saw: object) -> None:
    with SAID.open("w") as line:
        line.write(json.dumps({"what": what, "held": held, "saw": str(saw)}) + "\n")


def _kernels() -> set[str]:
    return {file.name.removesuffix(".nbc") for file in Path(os.environ["XDG_CACHE_HOME"]).rglob("*.nbc")}


def _uptime_s() -> str:
    return f"{Path('/proc/uptime').read_text().split()[0]} s after the start"


if __name__ == "__main__":
    main(sys.argv[1])
