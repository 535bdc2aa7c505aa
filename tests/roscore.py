"""ROS 1 of this machine's distribution for tests: a roscore's master, and programs of its Python."""

import contextlib
import os
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.ports import free_port

PYTHON, GENERATOR = Path("/usr/bin/python3"), Path("/usr/lib/genpy/genmsg_py.py")
PEERS = Path(__file__).parent / "ros1_peers"
START_S, END_S, LIFE_S = 60.0, 20.0, 900

DEFINITIONS = {
    "event_camera_msgs/EventPacket": "Header header\nuint32 height\nuint32 width\nuint64 seq\n"
    "uint64 time_base\nstring encoding\nbool is_bigendian\nuint8[] events\n",
    "dvs_msgs/Event": "uint16 x\nuint16 y\ntime ts\nbool polarity\n",
    "dvs_msgs/EventArray": "Header header\nuint32 height\nuint32 width\nEvent[] events\n",
}
"""As their packages have them, less the comments."""

needs_ros1 = pytest.mark.skipif(
    not all(
        path.exists()
        for path in (
            PYTHON,
            GENERATOR,
            Path("/usr/bin/rosmaster"),
            Path("/usr/lib/python3/dist-packages/sensor_msgs"),
            Path("/usr/share/std_msgs/msg"),
        )
    ),
    reason="ROS 1 is not installed: apt install ros-core python3-sensor-msgs ros-std-msgs",
)


class Ros1:
    """A master that runs. environment: of programs beside it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.port = free_port()
        self.environment = {
            "PATH": "/usr/bin:/bin",
            "ROS_MASTER_URI": f"http://127.0.0.1:{self.port}",
            "ROS_HOSTNAME": "127.0.0.1",
            "ROS_HOME": str(folder / "home"),
            "ROS_PACKAGE_PATH": str(folder / "packages"),
            "PYTHONPATH": str(folder / "python"),
            "HOME": str(folder),
        }
        self._generate()
        self._log = (folder / "roscore.log").open("ab")
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        self._process = subprocess.Popen(
            # roscore starts this in a session of its own, where it outlives a roscore that is killed.
            ["timeout", str(LIFE_S), "/usr/bin/rosmaster", "--core", "-p", str(self.port)],
            env=self.environment,
            stdout=self._log,
            stderr=self._log,
            start_new_session=True,
        )
        deadline = time.monotonic() + START_S
        while self.run("rostopic", "list", check=False, timeout_s=START_S).returncode:
            assert self._process.poll() is None, (self.folder / "roscore.log").read_text()
            assert time.monotonic() < deadline, "no roscore"

    def stop(self) -> None:
        """It ends at once."""
        if self._process is None:
            return
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait(END_S)

    def close(self) -> None:
        self.stop()
        self._log.close()

    def run(
        self, *command: str, check: bool = True, timeout_s: float = 60
    ) -> subprocess.CompletedProcess[str]:
        """A program of ROS, to its end."""
        return subprocess.run(
            command, env=self.environment, capture_output=True, text=True, timeout=timeout_s, check=check
        )

    def peer(self, name: str, *arguments: str) -> subprocess.Popen[str]:
        """One of ros1_peers/, in the system's Python."""
        return subprocess.Popen(
            [str(PYTHON), str(PEERS / f"{name}.py"), *arguments],
            env=self.environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def _generate(self) -> None:
        """Classes of messages that the distribution lacks, by genpy's own script."""
        for package in {name.partition("/")[0] for name in DEFINITIONS}:
            messages = self.folder / "msg" / package
            modules = self.folder / "python" / package
            messages.mkdir(parents=True)
            modules.mkdir(parents=True)
            (modules / "__init__.py").touch()
            names = [name for name in DEFINITIONS if name.startswith(package)]
            files = [messages / f"{name.partition('/')[2]}.msg" for name in names]
            for name, file in zip(names, files, strict=True):
                file.write_text(DEFINITIONS[name])
            include = [f"-I{package}:{messages}", "-Istd_msgs:/usr/share/std_msgs/msg"]
            output = ["-p", package, "-o", str(modules / "msg")]
            script = [str(PYTHON), str(GENERATOR)]
            self.run(*script, *output, *include, *map(str, files))
            self.run(*script, "--initpy", *output)


@contextlib.contextmanager
def ros1_running(folder: Path) -> Iterator[Ros1]:
    """A roscore on a port of its own, ended in any case."""
    ros1 = Ros1(folder)
    try:
        ros1.start()
        yield ros1
    finally:
        ros1.close()
