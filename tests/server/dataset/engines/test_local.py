"""A pool of processes: a killed one costs nothing, one that is killed each time costs its item."""

import os
import threading
from functools import partial
from pathlib import Path

import pytest
from tests.server.dataset.engines import deeds
from tests.server.dataset.rig import clips, content, made, spec

from voltcam_server.dataset import make as make_module
from voltcam_server.dataset.engines import LocalEngine, open_engine
from voltcam_server.dataset.engines.one_thread import ONE_THREAD
from voltcam_server.problems import UsageError


def test_items_are_made_in_other_processes_with_one_thread() -> None:
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    with LocalEngine(2) as engine:
        outcomes = list(engine.run(deeds.done, deeds.items(7), threading.Event()))
        assert {os.environ[name] for name in ONE_THREAD} == {"1"}
    assert {name: os.environ.get(name) for name in ONE_THREAD} == before
    assert sorted(one.record["name"] for one in outcomes) == [f"clip{i}" for i in range(7)]
    assert os.getpid() not in {one.record["pid"] for one in outcomes}


def test_a_killed_worker_costs_nothing(tmp_path: Path) -> None:
    with LocalEngine(2) as engine:
        work = partial(deeds.dies_once, marks=tmp_path)
        outcomes = list(engine.run(work, deeds.items(6), threading.Event()))
    assert sorted(one.record["name"] for one in outcomes) == [f"clip{i}" for i in range(6)]
    assert all(one.failed is None for one in outcomes)
    assert (tmp_path / "clip2").exists(), "one was killed"


def test_an_item_that_kills_each_worker_is_given_up_and_no_other() -> None:
    with LocalEngine(2) as engine:
        outcomes = list(engine.run(deeds.dies, deeds.items(6), threading.Event()))
    failed = [one for one in outcomes if one.failed is not None]
    assert [one.item.clip.name for one in failed] == ["clip2"]
    assert "its process was killed, 3 times: it may need more memory" in str(failed[0].failed)
    assert len(outcomes) == 6


def test_after_a_stop_nothing_begins() -> None:
    stop = threading.Event()
    with LocalEngine(1) as engine:
        names = []
        for outcome in engine.run(deeds.done, deeds.items(20), stop):
            names.append(outcome.record["name"])
            stop.set()
    assert sorted(names) == ["clip0", "clip1"], "what was under way, and what waited for the worker"


def test_a_set_from_two_processes_one_of_them_killed_is_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = {"comparator": {"theta_on": {"uniform": [0.2, 0.4]}}}
    wanted = spec(tmp_path, f"{clips(tmp_path / 'in', 6)}/*", parameters=drawn)
    made(wanted, tmp_path / "here")
    monkeypatch.setattr(
        make_module, "make_item", partial(deeds.make_and_die_once, marks=tmp_path, name="clip3.npz")
    )
    done = make_module.make_set(wanted, tmp_path / "two", partial(open_engine, "local", 2))
    assert (done.made, done.failed) == (6, 0)
    assert (tmp_path / "clip3.npz").exists(), "one was killed"
    assert content(tmp_path / "two") == content(tmp_path / "here")


def test_an_address_that_is_none_is_said() -> None:
    with pytest.raises(UsageError, match="--engine ray://head: give local, or dask://HOST:PORT"):
        open_engine("ray://head", 1)
