"""`voltcam doctor`: what works on this machine, and for how many pixels it is fast enough."""

import argparse
import os
import shutil
import socket
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import joblib
import numpy as np

from voltcam_simulator import Camera, Parameters, Simulator
from voltcam_video import backends
from voltcam_video.sources.scene import render

from .settings import Settings, load

SHARE = 0.7  # of a core's time that simulating may take: the rest is sending, and other programs
FPS = (30, 60, 240)
TRY_S = 1.0
LAST_PORT = 65535


def configure(parser: argparse.ArgumentParser) -> None:
    """Arguments of `voltcam doctor`."""
    parser.description = (
        "Say what works here: cameras, codecs, ports, disk, and for how many pixels it is fast enough."
    )
    parser.epilog = """\
examples:
  voltcam doctor
  voltcam doctor --config robot.yaml      with its camera and its ports"""
    parser.add_argument("--config", metavar="FILE", type=Path, help="a YAML file with settings")
    parser.set_defaults(run=_run)


def _run(args: argparse.Namespace) -> int:
    settings = load({}, args.config)
    well = True
    for good, what, words in _findings(settings):
        mark = {True: "ok", False: "no", None: "  "}[good]
        well &= good is not False
        sys.stdout.write(f"{mark:>4}  {what:<10} {words}\n")
        sys.stdout.flush()
    return 0 if well else 1


def _findings(settings: Settings) -> Iterator[tuple[bool | None, str, str]]:
    """(well, what, words); well is None for what is only told."""
    cores = joblib.cpu_count()
    yield (cores >= 2, "cores", f"{cores}" if cores >= 2 else "1: simulating and sending share it; give two")
    zmq = settings.zmq.removeprefix("tcp://")
    for address, flag in (
        (settings.http, "--http"),
        (zmq, "--zmq"),
        (settings.dv, "--dv"),
        (settings.foxglove, "--foxglove"),
    ):
        if "://" not in address and address != "off":
            yield _port(address, flag)
    if settings.udp != "off":
        yield _udp(settings.udp)
    free_gb = shutil.disk_usage(settings.recordings).free / 1e9
    yield free_gb > 1, "disk", f"{free_gb:.0f} GB free for recordings in {settings.recordings.resolve()}"
    yield from _devices()
    found = backends()
    yield (
        "FFMPEG" in found,
        "video",
        f"OpenCV reads by {', '.join(found) or 'nothing: video files cannot be read'}",
    )
    yield from _speed(settings.load_camera())


def _port(address: str, flag: str) -> tuple[bool, str, str]:
    host, _, port = address.rpartition(":")
    try:
        if int(port) > LAST_PORT:  # Python's own error for it is no OSError
            raise ValueError(f"ports end at {LAST_PORT}")
        with socket.create_server((host.strip("[]") or "127.0.0.1", int(port))):
            return True, "port", f"{address} is free"
    except (OSError, ValueError) as error:
        number = getattr(error, "errno", None)
        reason = os.strerror(number) if number and number > 0 else error
        return False, "port", f"{address}: {reason}; choose another with {flag}"


def _udp(url: str) -> tuple[bool, str, str]:
    """Whether there is such a host; not whether anybody listens, which nobody is told."""
    host, _, port = url.partition("://")[2].rpartition(":")
    try:
        socket.getaddrinfo(host.strip("[]"), int(port), type=socket.SOCK_DGRAM)
    except OSError as error:
        return False, "UDP", f"{url}: {error.strerror}; choose another with --udp"
    return True, "UDP", f"{url} can be sent to; whether anybody listens there is not known"


def _devices() -> Iterator[tuple[bool | None, str, str]]:
    devices = sorted(Path("/dev").glob("video*"))
    if not devices:
        yield None, "cameras", "no /dev/video* here: the built-in scene, files and streams are sources, too"
    for device in devices:
        readable = os.access(device, os.R_OK | os.W_OK)
        words = "" if readable else "; sudo usermod -aG video $USER, then log in again"
        yield readable, "camera", f"{device} {'can' if readable else 'cannot'} be opened{words}"


def _speed(camera: Camera) -> Iterator[tuple[bool | None, str, str]]:
    """Measured with the camera's effects at the built-in scene; the first seconds compile."""
    yield None, "speed", f"measured with {camera.name}, at the built-in scene, one core:"
    for fps in FPS:
        frame_s = _frame_s(camera.parameters, fps)
        pixels = SHARE / fps / frame_s * camera.width * camera.height
        own = pixels > camera.width * camera.height
        words = f"{fps:>3} frames/s: up to {_sizes(pixels)}; {camera.width} x {camera.height} takes"
        yield (own if fps == FPS[0] else None, "", f"{words} {100 * fps * frame_s:.0f} % of a core")


def _frame_s(parameters: Parameters, fps: int, width: int = 346, height: int = 260) -> float:
    """Time of a frame."""
    simulator = Simulator(width, height, parameters)
    period_us = round(1e6 / fps)
    simulator.advance(render(0, width, height), 0)
    simulator.advance(render(period_us, width, height), period_us)  # compiles
    took: list[float] = []
    while sum(took) < TRY_S:
        t_us = (len(took) + 2) * period_us
        image = render(t_us, width, height)
        before_s = time.monotonic()
        simulator.advance(image, t_us)
        took.append(time.monotonic() - before_s)
    return float(np.median(took))


def _sizes(pixels: float) -> str:
    """The largest usual sensor of so many pixels."""
    usual = ((128, 128), (240, 180), (346, 260), (640, 480), (1280, 720), (1920, 1080), (2560, 1440))
    fitting = [f"{width} x {height}" for width, height in usual if width * height <= pixels]
    return fitting[-1] if fitting else "less than 128 x 128"
