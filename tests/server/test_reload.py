"""Settings read again while the daemon runs: what is the same goes on, subscribers and all."""

import signal
from itertools import islice
from pathlib import Path

import pytest
from tests.ports import free_port

from voltcam_client import EventCamera

from .rig import PATIENCE_S, Rig, until

SCENE = {"uri": "scene", "width": 48, "height": 32, "fps": 100}


@pytest.fixture
def rig(tmp_path: Path) -> Rig:
    return Rig(tmp_path, "left", "right")


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
