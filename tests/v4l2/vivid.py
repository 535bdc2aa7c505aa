"""The kernel's test camera: plugged in, drawing, unplugged."""

import subprocess
import time
from pathlib import Path

DRIVER = Path("/sys/bus/platform/drivers/vivid")
DEVICE = "vivid.0"
LIMIT_S = 30
# One node for capture at each of two cameras, with a webcam's sizes and rates.
OPTIONS = ["n_devs=2", "node_types=0x1,0x1", "num_inputs=1,1", "input_types=0x0,0x0"]
STILL, FAST = 3, 6
NO_TEXT = 2
SETTLE_S = 3


def load() -> None:
    """Plug both cameras in; their nodes are there when it returns."""
    _run("busybox", "modprobe", "vivid", *OPTIONS)


def unload() -> bool:
    """Whether the kernel let the module go, which it does not while a program holds one of its files."""
    return subprocess.run(["busybox", "rmmod", "vivid"], capture_output=True, timeout=LIMIT_S).returncode == 0


def unbind() -> None:
    """Unplug the first camera, under whoever has it open."""
    (DRIVER / "unbind").write_text(DEVICE)


def disconnect(node: str) -> None:
    """As a cable with a loose contact: calls fail, and it is back when the last program has let it go."""
    control(node, disconnect=0)


def stamp_at_exposure(node: str) -> None:
    """By itself it stamps frames with an end that is yet to come, which a daemon does not believe."""
    control(node, timestamp_source=1)


def draw(node: str, movement: int) -> None:
    """Bars that stand still or move to the right, without the counters over them."""
    control(node, osd_text_mode=NO_TEXT, horizontal_movement=movement)


def control(node: str, **values: int) -> None:
    text = ",".join(f"{name}={value}" for name, value in values.items())
    _run("v4l2-ctl", "--device", node, "--set-ctrl", text)


def format_of(node: str) -> str:
    """What the driver itself says of its format and rate."""
    return _run("v4l2-ctl", "--device", node, "--get-fmt-video", "--get-parm")


def _run(*command: str) -> str:
    began_s = time.monotonic()
    done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S)
    if done.returncode:
        raise RuntimeError(
            f"{' '.join(command)}, {time.monotonic() - began_s:.1f} s: {done.stderr}{done.stdout}"
        )
    return done.stdout


def streaming(node: str) -> "subprocess.Popen[bytes]":
    """Another program that has the camera; it is to be killed."""
    command = ["v4l2-ctl", "--device", node, "--stream-mmap", "--stream-count=100000"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    time.sleep(SETTLE_S)
    return process
