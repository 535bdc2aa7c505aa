"""A process of a pool: Ctrl-C is its parent's, and it ends with that."""

import os
import signal
import subprocess
import sys
import time

PARENT = """
import os, signal, time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from voltcam_lab import pool_worker
if __name__ == "__main__":
    pool = ProcessPoolExecutor(1, get_context("spawn"), initializer=pool_worker.begin)
    print(pool.submit(os.getpid).result(), flush=True)
    pool.submit(time.sleep, 60)
    time.sleep(60)
"""


def test_it_leaves_ctrl_c_alone_and_does_not_outlive_its_parent() -> None:
    parent = subprocess.Popen([sys.executable, "-c", PARENT], stdout=subprocess.PIPE, text=True)
    assert parent.stdout is not None
    worker = int(parent.stdout.readline())
    os.kill(worker, signal.SIGINT)
    time.sleep(0.3)
    os.kill(worker, 0)  # it is there
    parent.kill()
    parent.wait(10)
    parent.stdout.close()
    until_s = time.monotonic() + 20
    while _runs(worker):
        assert time.monotonic() < until_s, "it outlives its parent"
        time.sleep(0.05)


def _runs(pid: int) -> bool:
    try:
        with open(f"/proc/{pid}/stat") as file:  # noqa: PTH123
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False
