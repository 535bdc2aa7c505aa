"""Several cameras in one daemon: each its own, a pair on one clock, settings read again while they run."""

import signal
from concurrent.futures import ThreadPoolExecutor
from itertools import islice
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
import yaml
from tests.ports import free_port
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from voltcam_client import Control, ControlError, EventCamera
from voltcam_client.packet import decode_message

from .rig import PATIENCE_S, Daemon, moving_frames, save_frames, tiny, until, voltcam

SCENE = {"uri": "scene", "width": 48, "height": 32, "fps": 100}


class Rig:
    """A config file of cameras of 24 x 16 pixels on free ports."""

    def __init__(self, folder: Path, *names: str) -> None:
        self.camera, self.file = folder / "tiny.yaml", folder / "rig.yaml"
        self.camera.write_text(tiny(comparator={"theta_on": 0.3, "theta_off": 0.3}).to_yaml())
        self.content: dict[str, Any] = {
            "camera": str(self.camera),
            "source": SCENE,
            "cameras": {name: {"zmq": f"tcp://127.0.0.1:{free_port()}"} for name in names},
        }
        self.write()

    def write(self) -> None:
        self.file.write_text(yaml.safe_dump(self.content))

    def zmq(self, name: str) -> str:
        return str(self.content["cameras"][name]["zmq"])

    def daemon(self, ready: bool = True) -> Daemon:
        return Daemon("--config", str(self.file), ready=ready, own_zmq=True)


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


@pytest.mark.parametrize("way", ["rest", "signal"])
def test_settings_read_again_leave_the_other_cameras_subscribers_alone(rig: Rig, way: str) -> None:
    with rig.daemon() as daemon, EventCamera(rig.zmq("left"), queue_length=100_000) as left:
        first = left.receive(PATIENCE_S)
        assert first is not None
        rig.content["cameras"]["right"]["seed"] = 5
        rig.content["cameras"]["up"] = {"zmq": f"tcp://127.0.0.1:{free_port()}"}
        rig.content["cameras"]["left"]["parameters"] = {"temperature_c": 45}
        rig.write()
        if way == "rest":
            answer = daemon.http.post("reload").raise_for_status().json()
            assert (answer["changed"], answer["restarted"], answer["added"]) == (["left"], ["right"], ["up"])
        else:
            daemon.process.send_signal(signal.SIGHUP)
        until(lambda: len(daemon.get("cameras")) == 3, "the third camera runs")
        assert daemon.get("camera?camera=right")["seed"] == 5
        assert daemon.get("parameters?camera=left")["parameters"]["temperature_c"] == 45
        with EventCamera(rig.zmq("up")) as up:
            assert up.receive(PATIENCE_S) is not None
        del rig.content["cameras"]["up"], rig.content["cameras"]["right"]
        rig.write()
        assert daemon.http.post("reload").json()["removed"] in (["up", "right"], ["right", "up"])
        for packet in islice(left, 200):
            last = packet
        assert left.lost_packets == 0
        assert last.seq > first.seq
        assert last.parameters_version == 1


def test_settings_that_cannot_be_change_nothing(rig: Rig) -> None:
    with rig.daemon() as daemon:
        good = rig.file.read_text()
        for bad, words in (
            ("cameras: {left: {sed: 1}}", "no such key"),
            ("cameras: {left: {}, right: {}}", "give each camera its own"),
            ("cameras: {left: {camera: /none.yaml}}", "cameras.left: /none.yaml"),
            ('zmq: "tcp://0.0.0.0:5999"', "no keys"),
            ("a: [", "not readable as YAML"),
        ):
            rig.file.write_text(bad)
            answer = daemon.http.post("reload")
            assert answer.status_code == 409
            assert words in answer.json()["detail"]
        assert len(daemon.get("cameras")) == 2
        rig.file.write_text(good + "http: 127.0.0.1:9\n")
        assert daemon.http.post("reload").json() | {"kept": []} == {
            "kept": [],
            "changed": [],
            "restarted": [],
            "added": [],
            "removed": [],
            "failed": {},
            "needs_restart": [],  # the command line says --http, and comes before the file
        }


def test_a_camera_that_cannot_start_is_said_and_the_others_go_on(rig: Rig) -> None:
    with rig.daemon() as daemon:
        rig.content["cameras"]["right"] |= {"source": {"uri": "/none.mp4"}, "seed": 9}
        rig.write()
        answer = daemon.http.post("reload").raise_for_status().json()
        assert "/none.mp4" in answer["failed"]["right"]
        assert answer["kept"] == ["left"]
        assert [camera["name"] for camera in daemon.get("cameras")] == ["left"]
        rig.content["cameras"]["right"] |= {"source": SCENE}
        rig.write()
        assert daemon.http.post("reload").json()["added"] == ["right"]


def test_a_recording_from_the_start_is_of_one_camera(rig: Rig, tmp_path: Path) -> None:
    done = voltcam(
        "serve", "--config", str(rig.file), "--record", str(tmp_path / "a.npz"), "--http", "127.0.0.1:0"
    )
    assert done.returncode == 1
    assert "--record is for one camera" in done.stderr


def test_a_config_of_several_is_checked_camera_by_camera(rig: Rig) -> None:
    done = voltcam("config", "check", str(rig.file))
    assert done.returncode == 0
    assert done.stdout.index("camera   left") < done.stdout.index("camera   right")
    assert rig.zmq("right") in done.stdout
