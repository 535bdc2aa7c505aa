"""`voltcam bench`, live: a daemon of its own with a recording played in real time, all effects typical.

How old the newest events are when they leave, and when a subscriber has them; how long an interval spends in
each stage; whether a large camera keeps up.
"""

import contextlib
import re
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from voltcam_client import Control, EventCamera
from voltcam_client.errors import VoltcamError
from voltcam_simulator import Camera

from .figure import Figure
from .scene import moving

FPS, LOOK_S, BEGIN_S = 60, 8.0, 60.0
PROGRAM = "import sys; from voltcam_client.cli import main; sys.exit(main())"
SUM = re.compile(r'^voltcam_stage_seconds_(sum|count)\{.*stage="(\w+)".*\} (\S+)$', re.MULTILINE)
AGE = re.compile(r'^voltcam_sent_age_seconds_bucket\{.*le="(\S+)".*\} (\S+)$', re.MULTILINE)
SHARES = np.linspace(0.0005, 0.9995, 1000)


class Watched(NamedTuple):
    """Of a daemon, over some seconds; ms."""

    ages: list[float]
    """Of the newest event of packets as they left: its quantiles at SHARES, to a millisecond."""
    ways: list[float]
    """From there to a subscriber in this process."""
    stages: dict[str, float]
    """Mean time of an interval in each stage."""
    lost: int
    """Frames that gave no events: dropped, or skipped."""
    simulated: int


def live(look_s: float = LOOK_S) -> list[Figure]:
    """The age of events of 346x260, paced and in bursts, and whether 1280x720 keeps up."""
    figures = []
    small = f"346x260 live at {FPS} frames/s, typical"
    for how, options in (("own pace", ()), ("--burst", ("--burst",))):
        seen = watched(346, 260, options, look_s)
        ages = at_receipt(seen)
        period = 1e3 / FPS if not options else 0.0
        stages = ", ".join(f"{stage} {ms:.1f}" for stage, ms in seen.stages.items())
        remark = (
            f"99 %: {np.quantile(ages, 0.99):.1f}; median on the way {np.median(seen.ways):.1f}; "
            f"frame period {period:.1f}; mean of {stages}"
        )
        figures.append(Figure.of(f"{small}, age at receipt, {how}", ages, "ms", remark))
    seen = watched(1280, 720, (), look_s)
    name = f"1280x720 live at {FPS} frames/s, typical, frames dropped or skipped"
    figures.append(Figure.of(name, [float(seen.lost)], "frames", f"of {seen.lost + seen.simulated}"))
    return figures


def watched(width: int, height: int, options: tuple[str, ...], look_s: float) -> Watched:
    """A daemon with a moving scene, once it runs. Raises VoltcamError where it does not begin."""
    with _daemon(width, height, options) as (http, zmq):
        control = Control(f"http://{http}")
        ways: list[float] = []
        stop = threading.Event()
        listener = threading.Thread(target=_listen, args=(zmq, stop, ways))
        listener.start()
        before, old = _frames(control), _metrics(http)
        time.sleep(look_s)  # each look costs the daemon a millisecond or two, so there is none in between
        after, new = _frames(control), _metrics(http)
        stop.set()
        listener.join(10)
    counts, sums = (
        {stage: new[kind][stage] - each for stage, each in old[kind].items()} for kind in ("count", "sum")
    )
    stages = {stage: 1e3 * sums[stage] / max(1, counts[stage]) for stage in sums}
    ages = _quantiles({bound: new["age"][bound] - each for bound, each in old["age"].items()})
    return Watched(ages, ways or [0.0], stages, after[0] - before[0], after[1] - before[1])


def _quantiles(below: dict[str, float]) -> list[float]:
    """ms at SHARES, of how many are at most so many seconds, in steps that the last of is inf."""
    bounds_ms = [1e3 * float(bound) for bound in below]
    bounds_ms[-1] = bounds_ms[-2]
    shares = np.array([0.0, *below.values()]) / max(1.0, below["+Inf"])
    return [float(ms) for ms in np.interp(SHARES, shares, [0.0, *bounds_ms])]


def at_receipt(seen: Watched) -> list[float]:
    """How old events are when a subscriber has them, ms: each age with each hundredth of the ways, as if the
    two had nothing to do with each other."""
    ways = np.quantile(seen.ways, np.linspace(0.005, 0.995, 100))
    return [float(age) for age in np.add.outer(seen.ages, ways).ravel()]


def _frames(control: Control) -> tuple[int, int]:
    """(without events, with)"""
    frames = control.status()["frames"]
    return int(frames["dropped"]) + int(frames["skipped"]), int(frames["simulated"])


def _metrics(http: str) -> dict[str, dict[str, float]]:
    """Of intervals "count" and "sum" of seconds by stage; of packets how many have an "age" of at most."""
    with urllib.request.urlopen(f"http://{http}/metrics", timeout=10) as answer:
        text = answer.read().decode()
    found: dict[str, dict[str, float]] = {"count": {}, "sum": {}, "age": {}}
    for kind, stage, value in SUM.findall(text):
        found[kind][stage] = float(value)
    for bound, value in AGE.findall(text):
        found["age"][bound] = float(value)
    return found


def _listen(zmq: str, stop: threading.Event, ways: list[float]) -> None:
    """As a robot does: how long packets are on their way here, by one clock."""
    with contextlib.suppress(TimeoutError), EventCamera(zmq, timeout_s=10) as camera:
        for packet in camera:
            ways.append((time.time_ns() - packet.stamp_ns) / 1e6)
            if stop.is_set():
                return


@contextlib.contextmanager
def _daemon(width: int, height: int, options: tuple[str, ...]) -> Iterator[tuple[str, str]]:
    """Where its HTTP and its packets are, once it runs."""
    with tempfile.TemporaryDirectory() as folder:
        scene, camera = Path(folder, "scene.npz"), Path(folder, "camera.yaml")
        frames = moving(FPS, width, height)
        np.savez(scene, frames=frames, t_us=np.arange(FPS) * 1_000_000 // FPS)
        sized = Camera.load("typical").model_copy(update={"width": width, "height": height})
        camera.write_text(sized.to_yaml())
        http, zmq = (f"127.0.0.1:{_free_port()}" for _ in range(2))
        command = [
            sys.executable, "-c", PROGRAM, "serve", "--camera", str(camera), "--source", str(scene), "--loop",
            "--http", http, "--zmq", f"tcp://{zmq}", "--dv", "off", *options,
        ]  # fmt: skip
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            _wait_until_it_runs(process, Control(f"http://{http}"))
            yield http, f"tcp://{zmq}"
        finally:
            process.terminate()
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(10)
            process.kill()


def _wait_until_it_runs(process: "subprocess.Popen[bytes]", control: Control) -> None:
    until_s = time.monotonic() + BEGIN_S
    while process.poll() is None and time.monotonic() < until_s:
        with contextlib.suppress(VoltcamError):
            status = control.status()
            if status["frames"]["simulated"] > 2 * FPS:  # the beginning, with its compiling, is over
                return
        time.sleep(0.1)
    raise VoltcamError(f"the daemon that was to be measured does not run within {BEGIN_S:g} s")


def _free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as free:
        return int(free.getsockname()[1])
