"""Without a container engine: image and compose files fit the project and its command line."""

import importlib.util
import json
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml

from voltcam_client.cli import main
from voltcam_server.settings import load

ROOT = Path(__file__).parents[2]
DOCKER = ROOT / "docker"


def instructions() -> list[tuple[str, str]]:
    """The Dockerfile as (keyword, rest), continued lines joined."""
    text = (DOCKER / "Dockerfile").read_text()
    text = re.sub(r"^#.*\n", "", text, flags=re.MULTILINE).replace("\\\n", " ")
    return [(line.split()[0], line.split(maxsplit=1)[1]) for line in text.splitlines() if line.strip()]


def services(file: str) -> dict[str, Any]:
    text = (DOCKER / file).read_text().replace("!reset", "")  # compose's own tag: what was there before goes
    return dict(yaml.safe_load(text)["services"])


def commands() -> list[list[str]]:
    """What `voltcam` is run with: by the images, and by the compose file."""
    images = [json.loads(rest) for keyword, rest in instructions() if keyword == "CMD"]
    ours = [each for each in services("compose.yaml").values() if "build" in each]
    return images + [each["command"] for each in ours if "command" in each]


def test_the_wheel_has_all_it_is_built_from() -> None:
    copied = {path for keyword, rest in instructions() if keyword == "COPY" for path in rest.split()[:-1]}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    packages = project["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"]
    needed = {"pyproject.toml", project["project"]["readme"], *project["project"]["license-files"]}
    assert copied == needed | {Path(package).parts[0] for package in packages}
    assert all((ROOT / path).exists() for path in copied)
    let_in = {line[1:] for line in (ROOT / ".dockerignore").read_text().splitlines() if line.startswith("!")}
    assert let_in == copied


def test_modules_that_are_run_while_an_image_is_built_are_there() -> None:
    modules = [
        name
        for keyword, rest in instructions()
        if keyword == "RUN"
        for name in re.findall(r"-m ([\w.]+)", rest)
    ]
    assert "voltcam_simulator.ahead" in modules
    assert all(importlib.util.find_spec(name) for name in modules)


def test_every_image_ends_as_the_unprivileged_user() -> None:
    users: dict[str, str] = {}
    stage = ""
    for keyword, rest in instructions():
        stage = rest.split()[-1] if keyword == "FROM" else stage
        if keyword == "USER":
            users[stage] = rest
    assert users == {"client": "10001", "daemon": "10001"}


@pytest.mark.parametrize("words", commands(), ids=" ".join)
def test_the_command_line_takes_it(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):  # where all else is right, the parser names the last word alone
        main([*words, "--no-such-option"])
    assert capsys.readouterr().err.endswith("unrecognized arguments: --no-such-option\n")


def test_the_daemon_listens_where_the_ports_are_published_on_this_machine_only() -> None:
    given = dict(
        word.split("=") for keyword, rest in instructions() if keyword == "ENV" for word in rest.split()
    )
    settings = load({}, environment=given)
    ports = [address.rpartition(":")[2] for address in (settings.http, settings.zmq)]
    exposed = next(rest.split() for keyword, rest in instructions() if keyword == "EXPOSE")
    assert exposed == ports
    assert services("compose.yaml")["voltcam"]["ports"] == [f"127.0.0.1:{port}:{port}" for port in ports]
    health = next(rest for keyword, rest in instructions() if keyword == "HEALTHCHECK")
    assert f":{ports[0]}/readyz" in health


def test_the_daemon_looks_through_the_device_that_is_passed_or_at_the_scene() -> None:
    daemon, override = services("compose.yaml")["voltcam"], services("scene.yaml")["voltcam"]
    seen = load({}, environment=daemon["environment"]).source.uri
    assert daemon["devices"] == [f"{seen}:{seen}"]
    assert daemon["group_add"]
    assert override["devices"] == []
    assert load({}, environment=override["environment"]).source.uri == "scene"


def test_prometheus_asks_the_daemon_by_a_name_that_it_answers_to() -> None:
    config = yaml.safe_load((DOCKER / "prometheus.yml").read_text())
    ((target,),) = [each["targets"] for job in config["scrape_configs"] for each in job["static_configs"]]
    name, _, port = target.partition(":")
    composed = services("compose.yaml")
    settings = load({}, environment=composed[name]["environment"])
    assert name in settings.access.hosts
    assert composed[name]["ports"][0].endswith(f":{port}")
    assert composed["prometheus"]["profiles"] == ["metrics"]
    assert re.fullmatch(r"\S+:v\d+\.\d+\.\d+", composed["prometheus"]["image"])


def test_containers_are_closed_and_the_subscriber_waits_for_the_camera() -> None:
    both = services("compose.yaml")
    for service in both.values():
        assert service["read_only"] is True
        assert service["cap_drop"] == ["ALL"]
        assert "privileged" not in service
        assert service["mem_limit"]
        assert service["pids_limit"]
    written = {volume.partition(":")[2] for volume in both["voltcam"]["volumes"]}
    assert written == set(json.loads(next(rest for keyword, rest in instructions() if keyword == "VOLUME")))
    assert both["listen"]["depends_on"] == {"voltcam": {"condition": "service_healthy"}}
