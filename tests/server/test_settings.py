"""Command line over environment over file over defaults, and errors that say where they are."""

import json
from pathlib import Path
from typing import Any

import pytest
import yaml

from voltcam_server.problems import UsageError
from voltcam_server.settings import Settings, load, parse_change, schema

SCHEMA = Path(__file__).parents[2] / "docs" / "voltcam.schema.json"


def config(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "voltcam.yaml"
    path.write_text(text)
    return path


def wrong(command_line: dict[str, object], path: Path | None = None, **environment: str) -> str:
    with pytest.raises(UsageError) as caught:
        load(command_line, path, environment).load_camera()
    text = str(caught.value)
    assert "\n" not in text
    return text


def test_defaults() -> None:
    settings = load({}, None, {})
    assert settings == Settings()
    assert (settings.http, settings.zmq) == ("127.0.0.1:8560", "tcp://127.0.0.1:5560")
    assert settings.dv == "127.0.0.1:7777"
    assert settings.packets.smooth
    camera = settings.load_camera()
    assert (camera.name, camera.width, camera.height) == ("davis346", 346, 260)


def test_precedence_key_by_key(tmp_path: Path) -> None:
    path = config(
        tmp_path,
        """
        seed: 1
        law: paper
        encoding: mono
        source: {uri: street.mp4, fps: 25, loop: true}
        parameters:
          comparator: {theta_on: 1.1, theta_off: 1.1}
          leak_noise: {k6: 1e-6}
        """,
    )
    environment = {
        "VOLTCAM_SEED": "2",
        "VOLTCAM_LAW": "exact",
        "VOLTCAM_SOURCE__FPS": "30",
        "VOLTCAM_PARAMETERS__COMPARATOR__THETA_ON": "1.2",
        "VOLTCAM_PACKETS__SMOOTH": "false",
        "PATH": "/usr/bin",
    }
    command_line = {"seed": 3, "parameters": {"comparator": {"theta_on": 1.3}}}
    settings = load(command_line, path, environment)
    assert (settings.seed, settings.law, settings.encoding) == (3, "exact", "mono")
    assert (settings.source.uri, settings.source.fps, settings.source.loop) == ("street.mp4", 30, True)
    assert not settings.packets.smooth
    parameters = settings.load_camera().parameters
    assert (parameters.comparator.theta_on, parameters.comparator.theta_off) == (1.3, 1.1)
    assert parameters.leak_noise.k6 == 1e-6


def test_each_camera_has_dv_streams_of_its_own() -> None:
    cameras: dict[str, Any] = {
        name: {"zmq": f"tcp://127.0.0.1:{port}"} for name, port in (("a", 1), ("b", 2), ("c", 3))
    }
    cameras["c"]["dv"] = "off"
    settings = load({"cameras": cameras}, None, {})
    assert [each.dv for each in settings.each().values()] == ["127.0.0.1:7777", "127.0.0.1:7781", "off"]
    cameras["a"]["dv"] = "127.0.0.1:7781"
    assert "cameras.b.dv: 127.0.0.1:7781 is that of a: give each camera its own" in wrong(
        {"cameras": cameras}
    )
    assert load({"cameras": cameras, "dv": "127.0.0.1:0"}, None, {}).each()["b"].dv == "127.0.0.1:0"


def test_off_needs_no_quotes(tmp_path: Path) -> None:
    assert load({}, config(tmp_path, "upsample: off"), {}).upsample == "off"


def test_a_fault_names_its_layer_its_key_and_what_may_be(tmp_path: Path) -> None:
    path = config(tmp_path, "source: {fps: -3}\nparameters: {comparator: {theta: 1}}\n")
    text = wrong({"seed": "many"}, path, VOLTCAM_LAW="none")
    assert f"{path}: source.fps: Input should be greater than 0, not -3" in text
    assert f"{path}: parameters.comparator.theta: there is no such key, only theta_on, theta_off" in text
    assert "environment: law: Input should be 'exact' or 'paper', not 'none'" in text
    assert "command line: seed: " in text


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("kamera: davis346", "kamera: there is no such key, only camera, law"),
        ("just words", "must hold keys and values"),
        ("a: [", "not readable as YAML"),
        ("http: 8560", "http: "),
        ("zmq: udp://127.0.0.1:1", "zmq: "),
        ("packets: {packet_us: 2000}", "packets.packet_us: Input should be less than or equal to 1000"),
        ("parameters: {temperature_c: .nan}", "temperature_c: Input should be a finite number"),
        (
            "camera: davis128",
            "unknown camera 'davis128': give one of davis240c, davis346, ideal, noisy, paper, paper240c, ",
        ),
    ],
)
def test_faults_in_the_file(tmp_path: Path, content: str, words: str) -> None:
    assert words in wrong({}, config(tmp_path, content))


def test_faults_elsewhere(tmp_path: Path) -> None:
    assert "none.yaml cannot be read: No such file or directory: check --config" in wrong(
        {}, tmp_path / "none.yaml"
    )
    assert "VOLTCAM_SEEED: there is no such setting, only camera" in wrong({}, None, VOLTCAM_SEEED="1")
    assert "VOLTCAM_SOURCE__ULI" not in wrong(
        {}, None, VOLTCAM_SOURCE__ULI="x"
    )  # pydantic names it in lower case
    assert "environment: source.uli: there is no such key" in wrong({}, None, VOLTCAM_SOURCE__ULI="x")
    assert wrong({}, None, VOLTCAM_SOURCE="{").startswith("environment: ")


def test_changes_on_the_command_line() -> None:
    assert parse_change("comparator.theta_on=1.5") == {"comparator": {"theta_on": 1.5}}
    assert parse_change("temperature_c=40") == {"temperature_c": 40}
    assert load({"parameters": parse_change("leak_noise.k6=1e-6")}, None, {}).parameters.leak_noise.k6 == 1e-6
    for text in ("comparator.theta_on", "=1", "comparator.theta_on="):
        with pytest.raises(UsageError, match=r"effect\.name=value"):
            parse_change(text)


def test_the_schema_in_docs_is_that_of_the_code() -> None:
    assert json.loads(SCHEMA.read_text()) == schema(), f"write it anew: voltcam schema > docs/{SCHEMA.name}"


def test_the_schema_knows_every_key_and_limit() -> None:
    definitions = schema()["$defs"]
    assert set(schema()["properties"]) == set(Settings.model_fields)
    assert definitions["Comparator"]["properties"]["theta_on"]["minimum"] > 0
    assert definitions["SourceRequest"]["additionalProperties"] is False
    assert yaml.safe_load(yaml.safe_dump(schema())) == schema()  # plain data


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"upsample": "banana"}, "upsample: give off, linear, cubic, auto or a number of steps from 1 to 64"),
        ({"upsample": 65}, "a number of steps from 1 to 64, not 65"),
        ({"http": "banana"}, "http: give it like 127.0.0.1:8560"),
        ({"zmq": "banana"}, "zmq: give it like tcp://127.0.0.1:5560"),
        ({"seed": "x"}, "seed: give a whole number"),
        ({"source": {"pixel_format": "too long"}}, "source.pixel_format: give it like MJPG"),
        ({"parameters": {"comparator": 3}}, "it has several parts: give parameters.comparator.NAME=VALUE"),
    ],
)
def test_words_are_the_users_and_not_the_validators(given: dict[str, Any], words: str) -> None:
    with pytest.raises(UsageError) as refusal:
        load(given, None, {})
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)
    assert "pattern" not in str(refusal.value)
    assert "literal" not in str(refusal.value)
