"""`voltcam serve` under a limit of memory, as the campaigns run it: its status, its memory, its end."""

import re
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import TracebackType
from typing import Any

import httpx

START_S = 60.0
LOGGED = re.compile(r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d (INFO|WARNING) ")  # what the daemon says by itself


class Daemon:
    """A daemon on free ports of loopback that may take `memory_bytes` of address space: a context manager."""

    def __init__(self, *arguments: str, memory_bytes: int) -> None:
        command = [str(Path(sys.executable).with_name("voltcam")), "serve", "--http", "127.0.0.1:0"]
        self.process = subprocess.Popen(
            [*command, "--zmq", "tcp://127.0.0.1:0", "--dv", "127.0.0.1:0", *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (memory_bytes, memory_bytes)),
        )
        assert self.process.stdout is not None
        banner = ""
        for line in self.process.stdout:
            banner += line
            if "Ctrl-C" in line:
                break
        page = re.search(r"http://\S+", banner)
        if page is None:
            raise SystemExit(f"the daemon did not start: {self.process.communicate()[1]}")
        self.url = page[0]
        self.http = httpx.Client(base_url=f"{self.url}api/v1/", trust_env=False, timeout=60)
        until(lambda: self._ready, START_S)

    @property
    def _ready(self) -> bool:
        return httpx.get(f"{self.url}readyz", trust_env=False, timeout=START_S).is_success

    def get(self, path: str) -> Any:
        """The answer of GET /api/v1/path."""
        return self.http.get(path).raise_for_status().json()

    @property
    def rss_mb(self) -> float:
        """Memory it holds now."""
        return self._memory("VmRSS")

    @property
    def most_rss_mb(self) -> float:
        """The most memory it has held."""
        return self._memory("VmHWM")

    def _memory(self, key: str) -> float:
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        found = re.search(rf"{key}:\s+(\d+) kB", status)
        return int(found[1]) / 1024 if found else float("nan")

    def end(self) -> tuple[int, float, str]:
        """Exit status, how many seconds the end took, standard error but for the log."""
        began_s = time.monotonic()
        self.process.send_signal(signal.SIGTERM)
        said = self.process.communicate(timeout=60)[1].splitlines()
        errors = "\n".join(line for line in said if not LOGGED.match(line))
        return self.process.returncode, time.monotonic() - began_s, errors

    def __enter__(self) -> "Daemon":
        return self

    def __exit__(
        self, _: type[BaseException] | None, __: BaseException | None, ___: TracebackType | None
    ) -> None:
        self.http.close()
        if self.process.poll() is None:
            self.process.kill()
            self.process.communicate()


def until(condition: Any, patience_s: float) -> float:
    """Wait for it; returns for how many seconds. inf when it has not come by then."""
    began_s = time.monotonic()
    while not condition():
        if time.monotonic() - began_s > patience_s:
            return float("inf")
        time.sleep(0.02)
    return time.monotonic() - began_s
