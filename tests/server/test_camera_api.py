"""REST of one camera, at a real web server over a small camera in process."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    invariant,
    rule,
    run_state_machine_as_test,
)
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from voltcam_client.formats import read
from voltcam_simulator import camera_names

from .rig import PATIENCE_S, SCENE, Api, serving, tiny


@pytest.fixture(scope="module")
def api() -> Iterator[Api]:
    with serving() as api:
        yield api


def test_the_camera(api: Api) -> None:
    camera = api.http.get("camera").json()
    assert (camera["name"], camera["width"], camera["height"]) == ("tiny", 24, 16)
    assert camera["zmq"] == "tcp://127.0.0.1:5560"
    assert camera["parameters"] == tiny().parameters.model_dump()


def test_parameters_change_and_say_from_when_on(api: Api) -> None:
    before = api.http.get("parameters").json()
    change = {"temperature_c": 41.5, "comparator": {"theta_on": 1.25}}
    after = api.http.patch("parameters", json=change).json()
    assert after["parameters_version"] == before["parameters_version"] + 1
    expected = before["parameters"] | {"temperature_c": 41.5}
    expected["comparator"]["theta_on"] = 1.25
    assert after["parameters"] == expected
    assert api.http.get("parameters").json() == after
    assert api.http.get("status").json()["parameters_version"] == after["parameters_version"]
    api.listener.wait(lambda it: it.packets[-1].parameters_version == after["parameters_version"])


@pytest.mark.parametrize(
    ("body", "code", "words"),
    [
        (
            '{"comparator": {"theta_on": -1}}',
            422,
            "comparator.theta_on: Input should be greater",
        ),
        (
            '{"temperature_c": 30, "comparator": {"theta_on": 1, "x": 1}}',
            422,
            "comparator.x: there is no such key",
        ),
        ('{"shutter": {"speed": 1}}', 422, "shutter: there is no such key, only temperature_c"),
        ('{"temperature_c": "warm"}', 422, "temperature_c: give a number"),
        ('{"temperature_c": true}', 422, "temperature_c: give a number"),
        ('{"leak_noise": {"k6": false}}', 422, "leak_noise.k6: give a number"),
        ('{"temperature_c": null}', 422, "temperature_c: give a number"),
        ('{"comparator": 3}', 422, "comparator: it has several parts"),
        ('{"temperature_c": 1e999}', 422, "temperature_c: Input should be a finite number"),
        ('{"temperature_c": NaN}', 400, "NaN is no number in JSON"),
        ('{"temperature_c": -Infinity}', 400, "-Infinity is no number in JSON"),
        ('{"temperature_c": 3', 400, "the body is not JSON"),
        ("", 400, "the body is not JSON"),
        ("\xff\xfe", 400, "the body is not JSON"),
        ("[" * 60000, 400, "the body is not JSON"),
        ("[1, 2]", 400, "must be a JSON object"),
        ('{"temperature_c": 3}' + " " * 70000, 413, "longer than 65536 bytes"),
    ],
)
def test_what_is_wrong_changes_nothing(api: Api, body: str, code: int, words: str) -> None:
    before = api.http.get("parameters").json()
    assert words in api.refused(code, "PATCH", "parameters", content=body.encode("latin-1"))
    assert api.http.get("parameters").json() == before


def test_the_schema_says_unit_and_limits_of_every_parameter(api: Api) -> None:
    schema = api.http.get("parameters/schema").json()
    assert schema["properties"]["temperature_c"]["unit"] == "C"
    for effect, parameters in tiny().parameters.model_dump(exclude={"temperature_c"}).items():
        section = schema["$defs"][schema["properties"][effect]["$ref"].rpartition("/")[2]]
        assert set(section["properties"]) == set(parameters)
        for name, about in section["properties"].items():
            assert "enum" in about or {"unit", "source", "maximum", "description"} <= set(about), (
                effect,
                name,
            )


def test_the_source_can_be_changed_and_refuses_what_is_not_there(api: Api, tmp_path: Path) -> None:
    assert api.http.get("source").json()["granted"]["kind"] == "scene"
    assert "none.mp4" in api.refused(422, "PUT", "source", json={"uri": str(tmp_path / "none.mp4")})
    assert "speed: there is no such key, only uri" in api.refused(422, "PUT", "source", json={"speed": 1})
    assert api.http.get("source").json()["state"] == "running"
    source = api.http.put("source", json=SCENE.model_dump() | {"fps": 50}).json()
    assert (source["uri"], source["granted"]["fps"], source["state"]) == ("scene", 50, "running")


def test_a_recording_begins_ends_and_overwrites_nothing(api: Api, tmp_path: Path) -> None:
    path = tmp_path / "out.npz"
    assert "nothing is being recorded" in api.refused(409, "DELETE", "recording")
    assert api.http.post("recording", json={"path": str(path)}).status_code == 201
    assert "end that recording first" in api.refused(409, "POST", "recording", json={"path": "other.npz"})
    count = len(api.listener.frames)
    api.listener.wait(lambda it: len(it.frames) > count + 5)
    assert api.http.get("status").json()["recording"]["recording"]
    done = api.http.delete("recording").json()
    assert done["error"] is None
    assert read(path).events.size == done["events"]
    assert "exists already" in api.refused(409, "POST", "recording", json={"path": str(path)})
    assert "suffix" in api.refused(422, "POST", "recording", json={"path": str(tmp_path / "a.mp3")})
    assert "cannot be created" in api.refused(
        409, "POST", "recording", json={"path": str(tmp_path / "no" / "a.raw")}
    )
    assert "path: " in api.refused(422, "POST", "recording", json={"path": ""})
    assert api.http.get("status").json()["recording"] is None


def test_a_camera_file_is_saved_and_loaded(api: Api) -> None:
    api.http.patch("parameters", json={"temperature_c": 44}).raise_for_status()
    saved = api.http.get("parameters/file")
    assert saved.headers["content-type"].startswith("application/yaml")
    api.http.patch("parameters", json={"temperature_c": 20, "leak_noise": {"k6": 1e-6}}).raise_for_status()
    loaded = api.http.put("parameters/file", content=saved.content).raise_for_status().json()
    assert loaded["parameters"]["temperature_c"] == 44
    assert api.http.get("parameters").json() == loaded
    assert "no such key" in api.refused(422, "PUT", "parameters/file", content="shutter: 1")
    assert "not readable" in api.refused(400, "PUT", "parameters/file", content="a: [")
    assert "must be a camera file" in api.refused(400, "PUT", "parameters/file", content="- 1")
    assert "has no height" in api.refused(422, "PUT", "parameters/file", content="width: 64")
    assert "longer than" in api.refused(413, "PUT", "parameters/file", content="#" * 70_000)
    assert api.http.get("parameters").json() == loaded


def test_biases_change_the_parameters_that_depend_on_them() -> None:
    with serving() as api:
        usual = api.http.get("biases").json()
        assert usual["ONBn_fine"] == 200
        before = api.http.get("parameters").json()
        after = api.http.patch("biases", json={"RefrBp_coarse": 3, "ONBn_fine": 100})
        assert after.json() == usual | {"RefrBp_coarse": 3, "ONBn_fine": 100}
        assert api.http.get("biases").json() == after.json()
        now = api.http.get("parameters").json()
        assert now["parameters_version"] == before["parameters_version"] + 1
        assert now["parameters"]["comparator"]["theta_on"] < before["parameters"]["comparator"]["theta_on"]


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({"ONBn_fine": 256}, "ONBn_fine: Input should be less than or equal to 255"),
        ({"OnBn_fine": 25}, "OnBn_fine: there is no such key"),
        ({"ONBn_coarse": 1.5}, "ONBn_coarse"),
    ],
)
def test_a_bias_that_cannot_be_changes_nothing(api: Api, body: dict[str, Any], words: str) -> None:
    before = api.http.get("parameters").json()
    refused = api.http.patch("biases", json=body)
    assert refused.status_code == 422
    assert words in refused.json()["detail"]
    assert api.http.get("parameters").json() == before


def test_presets_can_be_set(api: Api) -> None:
    presets = api.http.get("presets").json()
    assert presets.keys() == set(camera_names())
    assert api.http.patch("parameters", json=presets["noisy"]).json()["parameters"] == presets["noisy"]
    api.http.patch("parameters", json=tiny().parameters.model_dump()).raise_for_status()


def test_an_encoding_that_is_none_is_said(api: Api) -> None:
    url = f"ws://{api.address}/api/v1/events?encoding=morse"
    with connect(url) as client, pytest.raises(ConnectionClosed) as caught:
        client.recv(timeout=PATIENCE_S)
    assert caught.value.rcvd is not None
    assert "unknown encoding 'morse': give one of libcaer" in caught.value.rcvd.reason


class Patching(RuleBasedStateMachine):
    """Changes good and bad, against a model that is a dictionary and a number."""

    api: Api

    @initialize()
    def begin(self) -> None:
        answer = self.api.http.get("parameters").json()
        self.parameters, self.version = answer["parameters"], answer["parameters_version"]

    @rule(
        theta=st.floats(0.01, 100),
        temperature=st.none() | st.floats(-40, 125),
        k6=st.none() | st.floats(0, 1e-4),
    )
    def good(self, theta: float, temperature: float | None, k6: float | None) -> None:
        change: dict[str, Any] = {"comparator": {"theta_on": theta}}
        self.parameters["comparator"]["theta_on"] = theta
        if temperature is not None:
            change["temperature_c"] = self.parameters["temperature_c"] = temperature
        if k6 is not None:
            change["leak_noise"] = {"k6": k6}
            self.parameters["leak_noise"]["k6"] = k6
        self.version += 1
        assert self.api.http.patch("parameters", json=change).json()["parameters_version"] == self.version

    @rule(
        theta=st.floats(0.01, 100),
        bad=st.sampled_from(
            [
                {"temperature_c": 126},
                {"temperature_c": "NaN"},
                {"comparator": {"theta_off": 0}},
                {"comparator": {"theta": 1}},
                {"lens": {}},
                {"leak_noise": None},
            ]
        ),
    )
    def bad(self, theta: float, bad: dict[str, Any]) -> None:
        change = {"photon_noise": {"k3": 0.5}, **bad}
        change.setdefault("comparator", {}).setdefault("theta_on", theta)
        assert self.api.http.patch("parameters", content=json.dumps(change)).status_code == 422

    @invariant()
    def what_holds_is_what_was_taken(self) -> None:
        answer = self.api.http.get("parameters").json()
        assert answer == {"parameters": self.parameters, "parameters_version": self.version}


def test_any_order_of_changes(api: Api) -> None:

    Patching.api = api
    run_state_machine_as_test(
        Patching, settings=settings(max_examples=15, stateful_step_count=12, deadline=None)
    )
    latest = api.http.get("parameters").json()["parameters_version"]
    api.listener.wait(lambda it: it.packets[-1].parameters_version == latest)
    versions = [packet.parameters_version for packet in api.listener.packets]
    assert (np.diff(versions) >= 0).all()


def test_a_camera_that_is_none_is_said_wherever_one_is_asked_for(api: Api) -> None:
    for path in ("camera", "parameters", "parameters/file", "source", "status"):
        assert "no camera 'up', only tiny" in api.refused(404, "GET", f"{path}?camera=up")
    (listed,) = api.http.get("cameras").json()
    assert (listed["name"], listed["width"], listed["height"]) == ("tiny", 24, 16)
    assert listed["state"] == api.emulator.state[0]
    with connect(f"ws://{api.address}/api/v1/frames?camera=up") as client, pytest.raises(ConnectionClosed):
        client.recv(timeout=PATIENCE_S)
