"""The page on ROS 1, typed by someone who has it: its files, its subscriber, its launch file."""

import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.docs.blocks import DOCS
from tests.roscore import Ros1, needs_ros1, ros1_running
from tests.server.process import Daemon

pytestmark = needs_ros1

PAGE = DOCS / "how-to" / "ros-1.md"
FILE = re.compile(r"^`([\w./-]+)`\n\n```\w+\n(.*?)```", re.DOTALL | re.MULTILINE)
COMMANDS = re.compile(r"^```sh\n(.*?)```", re.DOTALL | re.MULTILINE)


@pytest.fixture
def ros1(tmp_path: Path) -> Iterator[Ros1]:
    """A roscore, the page's files in the folder `page`, and `voltcam` on the path."""
    with ros1_running(tmp_path) as running:
        for name, content in FILE.findall(PAGE.read_text(encoding="utf-8")):
            file = tmp_path / "page" / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(content)
        programs = tmp_path / "bin"
        programs.mkdir()
        (programs / "voltcam").symlink_to(Path(sys.executable).with_name("voltcam"))
        running.environment["PATH"] = f"{programs}:{running.environment['PATH']}"
        del running.environment["PYTHONPATH"]  # the page makes the class itself
        yield running


def command(begin: str) -> str:
    """The block of the page that begins so."""
    (block,) = [text for text in COMMANDS.findall(PAGE.read_text(encoding="utf-8")) if text.startswith(begin)]
    return block


@contextmanager
def typed(ros1: Ros1, text: str) -> Iterator[subprocess.Popen[str]]:
    process = subprocess.Popen(
        ["bash", "-euc", f"ROS_PACKAGE_PATH=${{ROS_PACKAGE_PATH:-}}; {text}"],
        cwd=ros1.folder / "page",
        env=ros1.environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    try:
        yield process
    finally:
        process.send_signal(signal.SIGINT)
        subprocess.run(["pkill", "-INT", "-s", str(process.pid)], check=False)
        process.communicate(timeout=60)


def test_the_subscriber_counts_the_events(ros1: Ros1) -> None:
    with (
        Daemon() as daemon,
        typed(ros1, command("voltcam ros1").replace("ros1", f"ros1 {daemon.zmq}")),
        typed(ros1, command("mkdir")) as subscriber,
    ):
        assert subscriber.stdout is not None
        line = subscriber.stdout.readline()
        assert re.fullmatch(r"\d+ \d{19} \d+ events, \d+ of them ON\n", line), line


def test_roslaunch_starts_the_bridge(ros1: Ros1) -> None:
    launch = ros1.folder / "page" / "camera.launch"
    with Daemon() as daemon:
        launch.write_text(launch.read_text().replace("tcp://127.0.0.1:5560", daemon.zmq))
        with typed(ros1, command("chmod")):
            deadline = time.monotonic() + 60
            while "/left/events" not in ros1.run("rostopic", "list").stdout:
                assert time.monotonic() < deadline
                time.sleep(0.2)
            assert "/rig/dvs/image_raw" in ros1.run("rostopic", "list").stdout
            assert "/rig/left" in ros1.run("rosnode", "list").stdout
            assert ros1.run("rostopic", "echo", "-n", "1", "/rig/dvs/image_raw/header").stdout
    assert shutil.which("roslaunch", path=ros1.environment["PATH"])
