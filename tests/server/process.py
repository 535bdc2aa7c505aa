"""`voltcam` in a process of its own: a command to its end, a daemon on free ports, one of several cameras."""

import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import httpx
import yaml
from tests.ports import free_port

from .rig import PATIENCE_S, tiny, until

LOGGED = re.compile(r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d (INFO|WARNING) ")  # what the daemon says by itself


def voltcam(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run a command to its end."""
    return subprocess.run(
        [voltcam_path(), *arguments],
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        env=os.environ | environment,
        check=False,
    )


def voltcam_path() -> str:
    return str(Path(sys.executable).with_name("voltcam"))


class Daemon:
    """`voltcam serve` on free ports, ready when made; a context manager that ends it by SIGTERM."""

    def __init__(
        self,
        *arguments: str,
        ready: bool = True,
        own_zmq: bool = False,
        command: tuple[str, ...] = ("serve",),
    ) -> None:
        command = (voltcam_path(), *command, "--http", "127.0.0.1:0", *arguments)
        command += () if own_zmq else ("--zmq", "tcp://127.0.0.1:0")
        self._told: str | None = None
        self._errors = tempfile.NamedTemporaryFile("w+")  # noqa: SIM115
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=self._errors, text=True)
        self.banner = ""
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.banner += line
            if "Ctrl-C" in line:
                break
        assert "Ctrl-C" in self.banner, (self.process.wait(PATIENCE_S), self.log)
        page = re.search(r"http://\S+", self.banner)
        assert page is not None
        self.url = page[0]
        self.http = httpx.Client(base_url=self.url + "api/v1/", trust_env=False)
        if not ready:
            return
        until(lambda: httpx.get(self.url + "readyz", trust_env=False).is_success, "ready")
        self.zmq = str(self.get("camera")["zmq"])

    @property
    def log(self) -> str:
        """What it has said on standard error."""
        return Path(self._errors.name).read_text() if self._told is None else self._told

    def get(self, path: str) -> Any:
        return self.http.get(path).raise_for_status().json()

    def patch(self, change: Any) -> Any:
        return self.http.patch("parameters", json=change).raise_for_status().json()

    def end(self, number: int = signal.SIGTERM) -> tuple[int, str, float]:
        """Exit status, standard error but for the log, and how many seconds the end took."""
        began_s = time.monotonic()
        self.process.send_signal(number)
        self.process.communicate(timeout=PATIENCE_S)
        self._told = self.log
        self._errors.close()
        errors = "".join(line for line in self.log.splitlines(keepends=True) if not LOGGED.match(line))
        return self.process.returncode, errors, time.monotonic() - began_s

    def __enter__(self) -> "Daemon":
        return self

    def __exit__(self, *_: object) -> None:
        self.http.close()
        if self.process.poll() is None:
            code, errors, _seconds = self.end()
            assert (code, errors) == (0, "")


class Rig:
    """A config file of cameras of 24 x 16 pixels on free ports."""

    def __init__(self, folder: Path, *names: str) -> None:
        self.camera, self.file = folder / "tiny.yaml", folder / "rig.yaml"
        self.camera.write_text(tiny(comparator={"theta_on": 0.3, "theta_off": 0.3}).to_yaml())
        self.content: dict[str, Any] = {
            "camera": str(self.camera),
            "source": {"uri": "scene", "width": 48, "height": 32, "fps": 100},
            "cameras": {name: {"zmq": f"tcp://127.0.0.1:{free_port()}"} for name in names},
        }
        self.write()

    def write(self) -> None:
        self.file.write_text(yaml.safe_dump(self.content))

    def zmq(self, name: str) -> str:
        return str(self.content["cameras"][name]["zmq"])

    def daemon(self, ready: bool = True) -> Daemon:
        return Daemon("--config", str(self.file), ready=ready, own_zmq=True)
