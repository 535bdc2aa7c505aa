"""Several cameras in one daemon: each its own, a pair on one clock, settings read again while they run."""

from concurrent.futures import ThreadPoolExecutor
from itertools import islice, pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import httpx
import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from voltcam_client import Control, ControlError, EventCamera
from voltcam_client.packet import decode_message
from voltcam_server.cameras import WORST_FIRST, Cameras, NoCameraError

from .process import Daemon, Rig, voltcam
from .rig import PATIENCE_S, moving_frames, save_frames, tiny, until

SCENE = {"uri": "scene", "width": 48, "height": 32, "fps": 100}


@pytest.fixture
def rig(tmp_path: Path) -> Rig:
    return Rig(tmp_path, "left", "right")


def test_each_has_parameters_and_streams_of_its_own(rig: Rig) -> None:
    with rig.daemon() as daemon:
        left, right = (Control(daemon.url, camera=name) for name in ("left", "right"))
        assert [camera["name"] for camera in daemon.get("cameras")] == ["left", "right"]
        assert left.camera()["zmq"] == rig.zmq("left")
        right.set({"temperature_c": 60})
        assert right.parameters()["parameters"]["temperature_c"] == 60
        assert left.parameters()["parameters"]["temperature_c"] != 60
        assert daemon.get("parameters") == left.parameters()  # the first, where none is named
        for name in ("left", "right"):
            with EventCamera(rig.zmq(name)) as camera:
                packet = camera.receive(PATIENCE_S)
                assert packet is not None
                assert packet.frame_id == name
            address = f"ws{daemon.url.removeprefix('http')}api/v1/events?camera={name}"
            with connect(address) as client:
                data = client.recv(timeout=PATIENCE_S)
                assert isinstance(data, bytes)
                assert decode_message(data).frame_id == name


def test_a_camera_that_is_none_is_said(rig: Rig) -> None:
    with rig.daemon() as daemon:
        with pytest.raises(ControlError, match="no camera 'up', only left, right") as caught:
            Control(daemon.url, camera="up").status()
        assert caught.value.status == 404
        address = f"ws{daemon.url.removeprefix('http')}api/v1/frames?camera=up"
        with connect(address) as client, pytest.raises(ConnectionClosed, match="no camera 'up'"):
            client.recv(timeout=PATIENCE_S)


def test_all_are_ready_or_the_daemon_is_not(rig: Rig, tmp_path: Path) -> None:
    short = save_frames(tmp_path / "short.npz", moving_frames(5, tiny()))
    rig.content["cameras"]["right"]["source"] = {"uri": short}
    rig.write()
    with rig.daemon(ready=False) as daemon:
        until(lambda: _ready(daemon)["status"] == "ended", "the right one has ended")
        assert _ready(daemon)["reason"].startswith("right: ")


def _ready(daemon: Daemon) -> Any:
    return httpx.get(f"{daemon.url}readyz", trust_env=False).json()


def test_a_pair_is_on_one_clock_also_when_looped(rig: Rig, tmp_path: Path) -> None:
    """Frames of one recorded time carry one stamp, whenever each camera was opened."""
    for name, seed in (("left", 1), ("right", 2)):
        frames = save_frames(tmp_path / f"{name}.npz", moving_frames(20, tiny(), seed), 20_000, start_us=seed)
        rig.content["cameras"][name]["source"] = {
            "uri": frames,
            "loop": True,
            "rig": "head",
            "fit": "stretch",
        }
    rig.write()
    with rig.daemon() as daemon:
        with ThreadPoolExecutor(2) as both:
            left, right = both.map(lambda name: _stamps(rig.zmq(name), 80), ("left", "right"))
        assert daemon.get("status")["state"] in ("running", "overloaded")
    # The two recordings differ by a microsecond, and so must the stamps, by no more and no less.
    begin, end = max(left[0], right[0]), min(left[-1], right[-1])
    left, right = (each[(each >= begin) & (each <= end)] for each in (left + 1, right))
    assert right.size > 20
    assert np.isin(right, left).mean() > 0.9  # either may have dropped a frame


def _stamps(endpoint: str, count: int) -> np.ndarray[Any, np.dtype[np.int64]]:
    with EventCamera(endpoint) as camera, camera.frames() as frames:
        return np.array([frame.t_us for frame in islice(frames, count)])


def test_a_recording_from_the_start_is_of_one_camera(rig: Rig, tmp_path: Path) -> None:
    done = voltcam(
        "serve", "--config", str(rig.file), "--record", str(tmp_path / "a.npz"), "--http", "127.0.0.1:0"
    )
    assert done.returncode == 1
    assert "--record is for one camera" in done.stderr


def fake(name: str, state: str = "running", reason: str = "", **emulator: Any) -> Any:
    of = {"state": (state, reason), "failure": None, "busy": False} | emulator
    return SimpleNamespace(name=name, emulator=SimpleNamespace(**of))


def test_a_camera_is_found_by_name_and_the_first_without_one() -> None:
    left, right = fake("left"), fake("right")
    cameras = Cameras([left, right])
    assert (cameras.get(), cameras.get("left"), cameras.get("right")) == (left, left, right)
    with pytest.raises(NoCameraError, match="no camera 'up', only left, right: GET"):
        cameras.get("up")
    cameras.replace([right])
    assert (list(cameras), cameras.get()) == ([right], right)
    with pytest.raises(NoCameraError, match="only none"):
        Cameras().get()


def test_all_are_as_well_as_the_worst() -> None:
    assert Cameras().state == ("starting", "no camera runs")
    assert Cameras([fake("one", "ended", "it is over")]).state == ("ended", "it is over")
    for worst, better in pairwise(WORST_FIRST):
        cameras = Cameras([fake("left", better, "so so"), fake("right", worst, "bad"), fake("up", better)])
        assert cameras.state == (worst, "right: bad")
    assert Cameras([fake("left"), fake("right")]).state == ("running", "")


def test_the_failure_of_one_is_that_of_all() -> None:
    error = RuntimeError("a bug")
    assert Cameras([fake("left"), fake("right")]).failure is None
    assert Cameras([fake("left"), fake("right", failure=error)]).failure is error
    assert Cameras([fake("left"), fake("right", busy=True)]).busy
    assert not Cameras([fake("left")]).busy
