"""Sets made by the command: watched, killed and made to their end, or on a cluster that loses a worker."""

import contextlib
import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import psutil

WORKERS = 2
LIMIT_S = 7200


class Watch:
    """mb: the most that one worker of a process has, as time goes on. cpu_s: of it and of each worker."""

    def __init__(self, pid: int) -> None:
        self.mb: list[float] = []
        self.cpu_s: dict[int, float] = {}
        self._process, self._done = psutil.Process(pid), threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def growth_mb(self) -> float:
        """Of the last quarter over the one before, in the median: items of a kind come together, and a single
        large one is no growth."""
        self._done.set()
        self._thread.join(10)
        quarter = len(self.mb) // 4
        if quarter == 0:
            return 0.0
        return float(np.median(self.mb[3 * quarter :]) - np.median(self.mb[2 * quarter : 3 * quarter]))

    def _run(self) -> None:
        while not self._done.wait(0.5):
            with contextlib.suppress(psutil.Error, ValueError):
                workers = self._process.children(recursive=True)
                for one in (self._process, *workers):
                    self.cpu_s[one.pid] = sum(one.cpu_times()[:2])
                self.mb.append(max(worker.memory_info().rss for worker in workers) / 1e6)


def command(spec: Path, out: Path, *more: str) -> list[str]:
    voltcam = "import sys; from voltcam_client.cli import main; sys.exit(main())"
    return [sys.executable, "-c", voltcam, "dataset", "make", str(spec), str(out), *more]


def once(spec: Path, out: Path, *more: str) -> tuple[float, Watch]:
    """Make a set; how long it took from the start of the command to its end."""
    began_s = time.monotonic()
    with subprocess.Popen(command(spec, out, *more), stdout=subprocess.PIPE, text=True) as process:
        watch = Watch(process.pid)
        said, _ = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0, said
    return time.monotonic() - began_s, watch


def killed_twice(spec: Path, out: Path, count: int) -> list[int]:
    """By SIGKILL, and by Ctrl-C; then made to its end. How many items there were each time."""
    found = []
    for part, number in ((0.3, signal.SIGKILL), (0.6, signal.SIGINT)):
        process = subprocess.Popen(command(spec, out, "--workers", str(WORKERS)), start_new_session=True)
        until_s = time.monotonic() + LIMIT_S
        while lines(out) < part * count and time.monotonic() < until_s:
            time.sleep(0.1)
        if number == signal.SIGKILL:
            os.killpg(process.pid, number)
        else:
            process.send_signal(number)
        process.wait(LIMIT_S)
        found.append(lines(out))
    once(spec, out, "--workers", str(WORKERS))
    return found


def lines(out: Path) -> int:
    path = out / "manifest.jsonl"
    return path.read_bytes().count(b"\n") if path.exists() else 0


@contextlib.contextmanager
def cluster(folder: Path) -> Iterator[str]:
    """A scheduler and two workers on loopback; one is killed after a while."""
    port = random.Random(os.getpid()).randrange(40_000, 60_000)
    dask = [sys.executable, "-m", "dask"]
    log = (folder / "cluster.log").open("w")
    start = partial(subprocess.Popen, stdout=log, stderr=log, start_new_session=True)
    processes = [
        start([*dask, "scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"]),
        start(
            [
                *dask, "worker", f"tcp://127.0.0.1:{port}", "--nworkers", str(WORKERS), "--nthreads", "1",
                "--no-dashboard", "--local-directory", str(folder),
            ]
        ),
    ]  # fmt: skip
    try:
        time.sleep(8)
        yield f"dask://127.0.0.1:{port}"
    finally:
        for process in processes:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        log.close()


def on_cluster(spec: Path, out: Path, folder: Path, count: int) -> float:
    """Kills the process of a worker in the middle. Seconds."""
    with cluster(folder) as address:
        began_s = time.monotonic()
        process = subprocess.Popen(command(spec, out, "--engine", address))
        while lines(out) < 0.4 * count and process.poll() is None:
            time.sleep(0.1)
        workers = [
            one for one in psutil.process_iter(["cmdline"])
            if str(folder) in " ".join(one.info["cmdline"] or []) or "distributed.nanny" in str(one.info)
        ]  # fmt: skip
        spawned = [
            child for one in workers for child in one.children() if "spawn_main" in str(child.cmdline())
        ]
        assert spawned, "no worker was found"
        spawned[0].kill()
        assert process.wait(LIMIT_S) == 0
        return time.monotonic() - began_s
