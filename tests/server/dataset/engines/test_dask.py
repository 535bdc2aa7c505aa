"""A real cluster of processes on loopback: workers that are killed cost nothing, and the set is the same."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import pytest
from tests.ports import free_port
from tests.server.dataset.engines import deeds
from tests.server.dataset.rig import clips, content, made, spec

from voltcam_server.dataset import make as make_module
from voltcam_server.dataset.engines import EngineGoneError, dask, open_engine
from voltcam_server.problems import UsageError

ROOT = Path(__file__).parents[4]

pytest.importorskip("distributed", reason="needs the extra cluster")


class Cluster:
    """A scheduler and `workers` workers, each a process; what keeps workers alive starts them again."""

    def __init__(self, folder: Path, workers: int) -> None:
        self.port = free_port()
        self.address = f"dask://127.0.0.1:{self.port}"
        self._log = (folder / "cluster.log").open("w")
        self._begin("scheduler", "--host", "127.0.0.1", "--port", str(self.port), "--no-dashboard")
        self._begin(
            "worker", f"tcp://127.0.0.1:{self.port}", "--nworkers", str(workers), "--nthreads", "1",
            "--no-dashboard", "--local-directory", str(folder),
        )  # fmt: skip

    def _begin(self, *arguments: str) -> None:
        environment = os.environ | {"PYTHONPATH": str(ROOT), "DASK_DISTRIBUTED__WORKER__DAEMON": "True"}
        process = subprocess.Popen(
            [sys.executable, "-m", "dask", *arguments],
            env=environment, stdout=self._log, stderr=self._log, start_new_session=True,
        )  # fmt: skip
        self._processes = [*getattr(self, "_processes", []), process]

    def kill(self, number: int) -> None:
        """The scheduler is 0."""
        os.killpg(self._processes[number].pid, signal.SIGKILL)
        self._processes[number].wait()

    def end(self) -> None:
        for process in self._processes:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        self._log.close()


@contextmanager
def cluster(folder: Path, workers: int = 2) -> Iterator[Cluster]:
    here = Cluster(folder, workers)
    try:
        until_s = time.monotonic() + 60
        while True:
            try:
                with open_engine(here.address, 1) as engine:
                    if engine.workers == workers:
                        break
            except UsageError:
                pass
            assert time.monotonic() < until_s, (folder / "cluster.log").read_text()
            time.sleep(0.3)
        yield here
    finally:
        here.end()


@pytest.mark.filterwarnings("ignore")  # of tornado and dask, when their cluster is killed
def test_a_set_from_a_cluster_one_worker_of_which_is_killed_is_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = {"comparator": {"theta_on": {"uniform": [0.2, 0.4]}}}
    wanted = spec(tmp_path, f"{clips(tmp_path / 'in', 8)}/*", parameters=drawn)
    made(wanted, tmp_path / "here")
    monkeypatch.setattr(
        make_module, "make_item", partial(deeds.make_and_die_once, marks=tmp_path, name="clip3.npz")
    )
    with cluster(tmp_path) as here:
        with (
            open_engine(here.address, 1) as engine,
            pytest.raises(UsageError, match=r"does not see /nowhere"),
        ):
            engine.check(Path("/nowhere"))
        done = make_module.make_set(wanted, tmp_path / "far", partial(open_engine, here.address, 1))
        assert (done.made, done.failed, done.left) == (8, 0, 0)
        assert (tmp_path / "clip3.npz").exists(), "one was killed"
        assert content(tmp_path / "far") == content(tmp_path / "here")
        with open_engine(here.address, 1) as engine:
            outcomes = list(engine.run(deeds.dies, deeds.items(6), threading.Event()))
        assert [one.item.clip.name for one in outcomes if one.failed is not None] == ["clip2"]
        assert len(outcomes) == 6
        monkeypatch.setattr(dask, "WITHOUT_WORKERS_S", 2.0)
        with open_engine(here.address, 1) as engine:
            here.kill(1)
            with pytest.raises(EngineGoneError, match="has had no worker for 2 s"):
                list(engine.run(deeds.done, deeds.items(2), threading.Event()))


@pytest.mark.filterwarnings("ignore")  # as above
def test_what_waits_where_a_worker_is_killed_is_not_blamed(tmp_path: Path) -> None:
    with cluster(tmp_path, workers=1) as here, open_engine(here.address, 1) as engine:
        outcomes = list(engine.run(deeds.dies, deeds.items(6), threading.Event()))
    assert [one.item.clip.name for one in outcomes if one.failed is not None] == ["clip2"]
    assert sorted(one.item.seed for one in outcomes) == list(range(6))


def test_a_scheduler_that_is_not_there_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dask, "CONNECT_S", 0.5)
    address = f"dask://127.0.0.1:{free_port()}"
    with pytest.raises(UsageError, match=f"{address}: no Dask scheduler answers"):
        open_engine(address, 1)
