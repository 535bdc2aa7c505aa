"""The first use of an installed Voltcam: `python first_use.py EXTRA`, where that extra is installed."""

import importlib.util
import json
import re
import signal
import subprocess
import sys
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import islice
from pathlib import Path

VOLTCAM = Path(sys.executable).with_name("voltcam")
PATIENCE_S = 120.0


def bare() -> None:
    """A robot gets the client and nothing heavy, and is told what the rest needs."""
    import voltcam_client

    assert voltcam_client.EventCamera
    for heavy in ("numba", "cv2", "fastapi", "pydantic"):
        assert importlib.util.find_spec(heavy) is None, f"{heavy} came with the bare install"
    answer = command("serve")
    assert answer.returncode == 2, answer
    assert "voltcam[server]" in answer.stderr, answer.stderr
    assert "Traceback" not in answer.stderr, answer.stderr


def simulator() -> None:
    """A bright frame after a dark one gives ON events."""
    import numpy as np

    from voltcam_simulator import Parameters, Simulator

    camera = Simulator(width=32, height=24, parameters=Parameters.of("davis346"), seed=1)
    camera.advance(np.full((24, 32), 40, np.uint8), 0)
    events = camera.advance(np.full((24, 32), 200, np.uint8), 10_000)
    assert events.size > 32 * 24, events.size
    assert events["p"].mean() > 0.9


def lab() -> None:
    """The commands are there, and an HDF5 recording is read."""
    import h5py
    import numpy as np

    from voltcam_client.formats import read

    simulator()
    for name in ("calibrate", "diagnose", "evaluate"):
        answer = command(name, "--help")
        assert answer.returncode == 0, answer
        assert "RECORDING" in answer.stdout, answer.stdout
    columns = {
        "t": np.arange(100),
        "x": np.arange(100) % 32,
        "y": np.arange(100) % 24,
        "p": np.arange(100) % 2,
    }
    with h5py.File("events.h5", "w") as file:
        for name, values in columns.items():
            file[f"events/{name}"] = values.astype(np.int64)
    assert read(Path("events.h5")).events.size == 100


def server() -> None:
    """A daemon's page and packets come, and SIGTERM ends it without a complaint."""
    with daemon() as url:
        take_packets(url)


def announce() -> None:
    """A daemon that is to be found is found."""
    import threading

    from zeroconf import ServiceBrowser, ServiceStateChange, Zeroconf

    from voltcam_server.announce import KIND

    there = threading.Event()

    def on_change(zeroconf: Zeroconf, service_type: str, name: str, state_change: ServiceStateChange) -> None:
        there.set()

    Path("camera.yaml").write_text("announce: true\n")
    with Zeroconf(interfaces=["127.0.0.1"]) as network:
        browser = ServiceBrowser(network, KIND, handlers=[on_change])
        with daemon("--config", "camera.yaml") as url:
            take_packets(url)
            assert there.wait(PATIENCE_S), "it was not found"
        browser.cancel()


def command(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [VOLTCAM, *arguments], capture_output=True, text=True, timeout=PATIENCE_S, check=False
    )


@contextmanager
def daemon(*arguments: str) -> Iterator[str]:
    """`voltcam serve` on free ports of this machine; the address of its page."""
    process = subprocess.Popen(
        [VOLTCAM, "serve", "--http", "127.0.0.1:0", "--zmq", "tcp://127.0.0.1:0", "--dv", "off", *arguments],
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    try:
        page = next(found for line in process.stdout if (found := re.search(r"http://\S+", line)))
        yield page[0]
        process.send_signal(signal.SIGTERM)
        assert process.wait(PATIENCE_S) == 0, process.returncode
    finally:
        process.kill()


def take_packets(url: str) -> None:
    from voltcam_client import EventCamera

    assert b"<html" in fetched(url)
    with EventCamera(json.loads(fetched(f"{url}api/v1/camera"))["zmq"]) as camera:
        assert sum(len(packet.events) for packet in islice(camera, 1000)) > 0


def fetched(url: str) -> bytes:
    direct = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    with direct.open(url, timeout=PATIENCE_S) as answer:
        return bytes(answer.read())


if __name__ == "__main__":
    {"bare": bare, "simulator": simulator, "lab": lab, "server": server, "announce": announce}[sys.argv[1]]()
