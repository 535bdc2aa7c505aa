"""`python -m voltcam_client.ros1`, as programs of ROS and its roscore see it."""

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.client.commands import assert_one_line
from tests.roscore import Ros1, needs_ros1, ros1_running

pytestmark = needs_ros1


@contextmanager
def node_running(ros1: Ros1, *arguments: str) -> Iterator[subprocess.Popen[str]]:
    """It has said what it publishes."""
    of_ros = {key: value for key, value in ros1.environment.items() if key.startswith("ROS")}
    process = subprocess.Popen(
        [sys.executable, "-m", "voltcam_client.ros1", *arguments],
        env=os.environ | of_ros,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        assert line.startswith("/"), process.communicate()
        yield process
    finally:
        process.kill()
        process.communicate()


def ended(process: subprocess.Popen[str]) -> str:
    """Why it has ended, in a line. Before it there may be words that nothing came, on a machine held up."""
    _, error = process.communicate(timeout=30)
    assert process.returncode == 1
    last_line = error.splitlines(keepends=True)[-1]
    assert_one_line(last_line)
    return last_line


def rate(ros1: Ros1, topic: str) -> str:
    """What `rostopic hz` prints first of a rate."""
    process = subprocess.Popen(
        ["rostopic", "hz", topic],
        env=ros1.environment | {"PYTHONUNBUFFERED": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    watchdog = threading.Timer(60, process.kill)
    watchdog.start()
    try:
        assert process.stdout is not None
        return next((line for line in process.stdout if line.startswith("average rate: ")), "none")
    finally:
        process.send_signal(signal.SIGINT)  # so that it says to the roscore that it leaves
        process.communicate()
        watchdog.cancel()


def test_programs_of_ros_know_the_topics(ros1: Ros1, running_camera: str) -> None:
    with node_running(ros1, running_camera, "--messages", "array", "__name:=eye", "--clock") as process:
        for topic, kind in (
            ("/dvs/events", "dvs_msgs/EventArray"),
            ("/dvs/image_raw", "sensor_msgs/Image"),
            ("/dvs/camera_info", "sensor_msgs/CameraInfo"),
            ("/dvs/imu", "sensor_msgs/Imu"),
            ("/clock", "rosgraph_msgs/Clock"),
        ):
            assert ros1.run("rostopic", "type", topic).stdout.strip() == kind
        echo = ros1.run("rostopic", "echo", "-n", "2", "/dvs/image_raw").stdout
        assert 'encoding: "mono8"' in echo
        assert echo.count("---") == 2
        assert float(rate(ros1, "/dvs/events").split()[2]) > 1
        assert "/dvs/events" in ros1.run("rosnode", "info", "/eye").stdout
        ros1.run("rosnode", "kill", "/eye")
        assert "/eye was told to end" in ended(process)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_it_ends_well_on_a_signal(ros1: Ros1, running_camera: str, number: signal.Signals) -> None:
    with node_running(ros1, running_camera) as process:
        process.send_signal(number)
        _, error = process.communicate(timeout=20)
        assert process.returncode == 0, error
    assert "/dvs/events" not in ros1.run("rostopic", "list").stdout


def test_it_ends_with_the_roscore(tmp_path: Path, running_camera: str) -> None:
    with ros1_running(tmp_path) as ros1, node_running(ros1, running_camera) as process:
        ros1.stop()
        assert "has ended: start it" in ended(process)
