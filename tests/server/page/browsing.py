"""A daemon with its page, and the browser that looks at it."""

import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import Page, Response
from tests.ports import free_port

CHROMIUM = Path("/usr/bin/chromium")
CHROMIUM_ARGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"]
CHROMIUM_ARGS += ["--disable-background-networking", "--disable-component-update", "--disable-sync"]
START_S = 60

needs_chromium = pytest.mark.skipif(not CHROMIUM.exists(), reason=f"no Chromium at {CHROMIUM}")


class Daemon:
    """`voltcam serve` on ports of its own, which stay the same over a restart."""

    def __init__(self, *arguments: str, folder: Path | None = None) -> None:
        self.http, self.zmq = (f"127.0.0.1:{free_port()}" for _ in range(2))
        self.url = f"http://{self.http}/"
        self.arguments = arguments if "--config" in arguments else ("--zmq", f"tcp://{self.zmq}", *arguments)
        self.folder = folder or Path()
        self.start()

    def start(self) -> None:
        command = [str(Path(sys.executable).with_name("voltcam")), "serve"]
        command += ["--http", self.http, *self.arguments]
        self.process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=self.folder
        )
        deadline = time.monotonic() + START_S
        while not self.ready():
            assert self.process.poll() is None, "the daemon ended"
            assert time.monotonic() < deadline, "the daemon is not ready"
            time.sleep(0.1)

    def ready(self) -> bool:
        try:
            return httpx.get(self.url + "readyz").is_success
        except httpx.TransportError:
            return False

    def kill(self) -> None:
        self.process.kill()
        self.process.wait()

    def get(self, path: str) -> Any:
        return httpx.get(f"{self.url}api/v1/{path}").raise_for_status().json()

    def patch(self, change: dict[str, Any]) -> httpx.Response:
        return httpx.patch(f"{self.url}api/v1/parameters", json=change)

    def theta_on(self) -> float:
        return float(self.get("parameters")["parameters"]["comparator"]["theta_on"])


def theta_box(page: Page) -> Any:
    return page.locator("[id='p-comparator.theta_on']")


def is_patch(response: Response) -> bool:
    return response.request.method == "PATCH"
