"""Settings read again while the daemon runs: what is the same goes on, subscribers and all."""

import signal
from itertools import islice
from pathlib import Path
from typing import Any, ClassVar

import pytest
from tests.ports import free_port

from voltcam_client import EventCamera
from voltcam_server import reload as reload_module
from voltcam_server.cameras import Cameras
from voltcam_server.plan import Plan, plans_of
from voltcam_server.problems import UsageError
from voltcam_server.reload import Reload, ReloadAnswer
from voltcam_server.settings import Settings, load

from .process import Rig
from .rig import PATIENCE_S, until

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
        for packet in islice(left, 20_000):  # what was queued before the change comes first
            last = packet
            if last.parameters_version == 1:
                break
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


class FakeCamera:
    """In place of one that runs: it keeps what is asked of it."""

    made: ClassVar[list["FakeCamera"]] = []

    def __init__(self, plan: Plan, around: object = None) -> None:
        self.plan, self.name = plan, plan.name
        self.calls: list[str] = []
        FakeCamera.made.append(self)

    of = classmethod(lambda cls, plan, around: cls(plan, around))

    def start(self) -> None:
        self.calls.append("start")
        if self.plan.settings.seed == 13:
            raise UsageError("13 brings\nbad luck")

    def stop(self) -> None:
        self.calls.append("stop")


class Fakes:
    """Reload over such cameras; `content` is what the settings say."""

    def __init__(self, **content: Any) -> None:
        self.content = content
        FakeCamera.made = []
        self.cameras = Cameras([FakeCamera(plan) for plan in plans_of(self.settings())])  # type: ignore[misc]
        self.reload = Reload(self.cameras, None, self.settings(), self.settings)  # type: ignore[arg-type]

    def settings(self) -> Settings:
        return load(self.content, None, {})

    @property
    def names(self) -> list[str]:
        return [camera.name for camera in self.cameras]


@pytest.fixture
def fakes(monkeypatch: pytest.MonkeyPatch) -> Fakes:
    monkeypatch.setattr(reload_module, "RunningCamera", FakeCamera)
    return Fakes(cameras={name: {"zmq": f"ipc:///{name}"} for name in ("left", "right")})


def test_what_is_the_same_is_left_alone(fakes: Fakes) -> None:
    answer = fakes.reload()
    assert answer == ReloadAnswer(kept=["left", "right"])
    assert answer.words == "kept: left, right"
    assert all(camera.calls == [] for camera in FakeCamera.made)


def test_another_seed_is_another_camera_and_the_order_is_that_of_the_settings(fakes: Fakes) -> None:
    fakes.content["cameras"] = {
        "up": {"zmq": "ipc:///up"}, "right": {"zmq": "ipc:///right", "seed": 2},
    }  # fmt: skip
    left, right = FakeCamera.made
    answer = fakes.reload()
    assert answer == ReloadAnswer(added=["up"], restarted=["right"], removed=["left"])
    assert answer.words == "restarted: right; added: up; removed: left"
    assert fakes.names == ["up", "right"]
    assert left.calls == right.calls == ["stop"]
    assert [camera.calls for camera in fakes.cameras] == [["start"]] * 2


def test_one_that_does_not_start_is_ended_and_named_in_a_line(fakes: Fakes) -> None:
    fakes.content["cameras"]["right"]["seed"] = 13
    answer = fakes.reload()
    assert (answer.kept, answer.failed) == (["left"], {"right": "13 brings bad luck"})
    assert fakes.names == ["left"]
    assert FakeCamera.made[-1].calls == ["start", "stop"]
    fakes.content["cameras"]["right"]["seed"] = 0
    assert fakes.reload().added == ["right"]


def test_what_holds_from_the_next_start_on_is_said(fakes: Fakes) -> None:
    fakes.content |= {"http": "127.0.0.1:9", "announce": True}
    assert set(fakes.reload().needs_restart) == {"http", "announce"}


def test_settings_that_cannot_be_read_end_nothing_and_do_not_lock(fakes: Fakes) -> None:
    fakes.content["seed"] = "many"
    for _ in range(2):
        with pytest.raises(UsageError, match="seed"):
            fakes.reload()
    assert fakes.names == ["left", "right"]
    assert all(camera.calls == [] for camera in FakeCamera.made)


def test_two_do_not_read_the_settings_at_once(fakes: Fakes) -> None:
    refused: list[str] = []

    def read() -> Settings:
        try:
            fakes.reload()
        except UsageError as error:
            refused.append(str(error))
        return fakes.settings()

    fakes.reload._read = read
    assert fakes.reload().kept == ["left", "right"]
    assert refused == ["the settings are being read already: wait until that is done"]
