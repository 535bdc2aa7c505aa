"""Requests of all kinds from the OpenAPI document, by schemathesis: by who may change, by who may only look,
by who may nothing, and to a daemon without tokens."""

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from functools import reduce
from operator import getitem
from pathlib import Path

import httpx
import pytest

from voltcam_server.access import Tokens
from voltcam_server.compiling import CompiledEffects
from voltcam_server.emulator import Emulator
from voltcam_server.transports import WebSocketTransport
from voltcam_simulator import Parameters

from .rig import SCENE, app_of, open_access, running, started, tiny, web_server

VIEW, CONTROL = "view-" + "v" * 20, "control-" + "c" * 20
EXAMPLES = 15  # of each operation, beside the limits of every value, which are tried all
EXAMPLES_OF_REFUSED = 3  # of one who is let in nowhere: all answers are alike
# From a clone these take 25 and 16 s to compile: the client waits 10 s. A wheel brings them compiled.
SLOW_TO_COMPILE = Parameters().changed(
    {"photoreceptor_bandwidth": {"cutoff_hz": 100}, "residual_kick": {"after_on": 0.1}}
)
# A path that is well-formed may still be that of no file.
CONFIG = """
[[operations]]
include-path = ["/api/v1/source", "/api/v1/diagnosis"]
checks.positive_data_acceptance.enabled = false
"""


@pytest.fixture
def address(guarded: bool, tmp_path: Path) -> Iterator[str]:
    tokens = Tokens([("view", VIEW), ("control", CONTROL)] if guarded else [])
    folder = tmp_path / "recordings"
    folder.mkdir()
    access = open_access(folder, source_folders=[folder], source_urls=[], streams=[])
    CompiledEffects("exact").prepare(SLOW_TO_COMPILE)
    websockets = WebSocketTransport("")  # nobody subscribes: no listener keeps up with some legal values
    with started(Emulator(tiny(), SCENE, transports=[websockets]), websockets) as emulator:
        app = app_of(running(emulator, websockets), access=replace(access, tokens=tokens))
        with web_server(app) as where:
            yield where


def headers(token: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {token}"} if token else {}


def state_of(address: str) -> tuple[object, ...]:
    """What nobody may change who has no right to."""
    with httpx.Client(
        base_url=f"http://{address}/api/v1/", headers=headers(CONTROL), trust_env=False
    ) as http:
        source, status = http.get("source").json(), http.get("status").json()
        return http.get("parameters").json(), source["request"], status["recording"]


@pytest.mark.parametrize(
    ("guarded", "token"),
    [(True, CONTROL), (True, VIEW), (True, ""), (True, "x" * 30), (False, "")],
    ids=["control", "view", "no token", "a wrong token", "a daemon without tokens"],
)
def test_requests_of_all_kinds(address: str, token: str, guarded: bool, tmp_path: Path) -> None:
    """No 5xx, every answer as documented, whatever is legal is taken and whatever is not is refused."""
    document = httpx.get(f"http://{address}/api/v1/openapi.json", headers=headers(CONTROL), trust_env=False)
    (tmp_path / "openapi.json").write_text(document.text)
    (tmp_path / "schemathesis.toml").write_text(CONFIG)
    before = state_of(address)
    command = [
        str(Path(sys.executable).with_name("st")),
        "--config-file",
        str(tmp_path / "schemathesis.toml"),
    ]
    command += ["run", str(tmp_path / "openapi.json"), "--url", f"http://{address}"]
    examples = EXAMPLES if token in (CONTROL, VIEW) or not guarded else EXAMPLES_OF_REFUSED
    command += ["--max-examples", str(examples), "--seed", "1", "--generation-database", "none", "--no-color"]
    command += [part for name, value in headers(token).items() for part in ("--header", f"{name}: {value}")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stdout
    operations = sum(len(ways) for ways in document.json()["paths"].values())
    assert re.search(rf"Tested: {operations}\b", done.stdout), done.stdout
    if guarded and token != CONTROL:
        assert state_of(address) == before


@pytest.mark.parametrize("guarded", [True])
def test_every_reference_of_the_document_leads_somewhere(address: str) -> None:
    answer = httpx.get(f"http://{address}/api/v1/openapi.json", headers=headers(CONTROL), trust_env=False)
    document = answer.json()
    references = set(re.findall(r'"\$ref": "([^"]+)"', json.dumps(document)))
    assert len(references) > 20
    for reference in references:
        assert reduce(getitem, reference.removeprefix("#/").split("/"), document)
