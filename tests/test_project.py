"""What the project says of itself in several places agrees: versions of Python, of Voltcam, and CI."""

import ast
import os
import re
import tomllib
from collections import Counter
from importlib import metadata
from pathlib import Path
from typing import Any

import pytest
import yaml

from voltcam_client.cli import main

ROOT = Path(__file__).parents[1]
SOURCES = [path for room in ("client", "simulator", "server") for path in (ROOT / room).rglob("*.py")]
PROJECT: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


@pytest.fixture(scope="module")
def job() -> dict[str, Any]:
    """The one job of the forge's CI."""
    (job,) = yaml.safe_load((ROOT / ".github" / "workflows" / "ci.yml").read_text())["jobs"].values()
    assert isinstance(job, dict)
    return job


def test_ci_runs_what_a_developer_runs_on_each_python(job: dict[str, Any]) -> None:
    named = re.findall(r"Python :: (3\.\d+)$", "\n".join(PROJECT["classifiers"]), re.MULTILINE)
    assert job["strategy"]["matrix"]["python"] == named
    assert PROJECT["requires-python"] == f">={named[0]}"
    assert [step["run"] for step in job["steps"] if "run" in step] == [".ci/run"]
    assert os.access(ROOT / ".ci" / "run", os.X_OK)


def test_ci_pins_its_actions_and_needs_no_secret(job: dict[str, Any]) -> None:
    actions = [step["uses"] for step in job["steps"] if "uses" in step]
    assert actions
    assert all(re.fullmatch(r"actions/[a-z-]+@v\d+", action) for action in actions)
    assert "secrets" not in str(job)


def test_the_version_stands_in_one_place(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    assert capsys.readouterr().out == f"voltcam {metadata.version('voltcam')}\n"
    assert metadata.version("voltcam") == PROJECT["version"]
    assert len(SOURCES) > 100
    assert not [path for path in SOURCES if f'"{PROJECT["version"]}"' in path.read_text()]


def test_a_class_name_means_one_thing() -> None:
    names = Counter(
        node.name
        for path in SOURCES
        for node in ast.parse(path.read_text()).body
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_")
    )
    assert len(names) > 200
    assert not [name for name, count in names.items() if count > 1]
